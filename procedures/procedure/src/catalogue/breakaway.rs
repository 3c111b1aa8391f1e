//! Stiction: the motor current rises until the joint breaks away, at many positions and in both directions.
//!
//! Corke 1994 raises the current until the encoder increases in five consecutive samples. A joint whose friction falls
//! with speed creeps before it breaks away. A faster torque ramp then gives a lower breakaway torque (Canudas de Wit,
//! Olsson, Åström, Lischinsky 1995). Only a slow ramp approximates the friction at rest.
//!
//! Gravity loads a joint without a torque sensor. It is estimated from the angles of the breakaways. A constant part of
//! it looks like a difference of the directions, so that only the mean of both directions is free of it on a short arc.

use super::legs::{ACCELERATION, Legs, sample_rate};
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::findings::{Unusable, verdict};
use crate::identification::{Identification, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{EndCondition, Plan, PlanFault};
use jointbench_instrument::{Kind, RunTable};
use std::f64::consts::TAU;

pub(super) mod ramps;
pub(super) mod torques;

use ramps::{Onset, RUNAWAY_RAD_S, Ramps, onsets, ramp_step_nm};
use torques::{BreakawayPoint, Torques, distribution, over_angle};

pub(super) struct Breakaway;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "breakaway",
    title: "Breakaway",
    summary: "Ramps the motor current until the joint breaks away, at many positions and in both directions. The \
              velocity loop takes over as soon as the joint moves.",
    kind: Kind::Friction,
    schema: &[
        Parameter::count("positions", "Number of positions in each direction", 12, [2, 200]),
        Parameter::number("arc_rad", "Arc of the positions (link)", "rad", TAU, [0.02, TAU]),
        Parameter::number("top_torque_nm", "Maximum torque of the ramp (motor)", "Nm", 0.08, [1e-3, 100.0]),
        Parameter::number("ramp_nm_s", "Torque ramp rate (motor)", "Nm/s", 0.005, [1e-4, 10.0]),
        Parameter::count("increases", "Consecutive encoder increments", 5, [2, 50]),
        Parameter::number("speed_rad_s", "Approach speed (motor)", "rad/s", 60.0, [1.0, 1000.0]),
        ACCELERATION,
        sample_rate(250.0),
    ],
};

impl Procedure for Breakaway {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let rate_hz = values.number("sample_rate_hz");
        let ramps = Ramps {
            positions: values.count("positions"),
            arc_rad: values.number("arc_rad"),
            speed_rad_s: values.number("speed_rad_s"),
            top_a: values.number("top_torque_nm") / bench.constants.torque_constant_nm_per_a,
            ramp_s: values.number("top_torque_nm") / values.number("ramp_nm_s"),
            until: EndCondition { increases: values.count("increases"), speed_rad_s: RUNAWAY_RAD_S },
        };
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        ramps.plan(&mut legs, bench);
        Ok(legs.friction_plan(self, values, bench, rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[("Nm", "tau_b tau_b_positive tau_b_negative tau_b_difference deviation")])
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(values, run))
    }
}

fn identify(values: &Values, run: &RunTable) -> Result<Identification, Unusable> {
    let Some(setpoint) = run.column("motor_current_setpoint_a") else {
        return Err(Unusable::InsufficientData(
            "The run has no motor current set-point, so it belongs to another procedure.",
            "Run breakaway.",
        ));
    };
    let km = run.meta().torque_constant_nm_per_a.unwrap_or(1.0);
    let gear = run.meta().gear_ratio.unwrap_or(1.0);
    let position = run.column("motor_position_rad").unwrap_or_default();
    let link = |row: usize| run.column("link_position_rad").map_or(position[row] / gear, |link| link[row]);
    let increases = values.count("increases") as usize;
    let top_a = values.number("top_torque_nm") / km;
    let (onsets, held) = onsets(run, setpoint, increases, top_a);
    let point = |onset: Onset| BreakawayPoint {
        link_rad: link(onset.end - 1).rem_euclid(TAU),
        torque_nm: km * onset.current_a.abs(),
        sign: onset.current_a.signum(),
    };
    let mut points: Vec<BreakawayPoint> = onsets.into_iter().map(point).collect();
    let step_nm = ramp_step_nm(values);
    let torques = match run.column("link_torque_nm") {
        Some(_) => Torques::of(&points, step_nm),
        None => Torques::without_gravity(&mut points, step_nm),
    };
    let Some(torques) = torques else {
        let advice =
            "Increase top_torque_nm. An arm moves by its weight where gravity exceeds friction: reduce arc_rad.";
        return Err(Unusable::InsufficientData("Too few breakaway events.", advice));
    };
    let all: Vec<f64> = points.iter().map(|b| b.torque_nm).collect();
    Ok(Identification {
        verdict: if held == 0 { Verdict::Identified } else { Verdict::Inconclusive },
        summary: torques.sentence("Breakaway torque", "motor side", all.len()),
        advice: (held > 0)
            .then(|| format!("The joint did not break away at {held} positions. Increase top_torque_nm.")),
        quantities: torques.quantities("Breakaway torque"),
        figures: vec![over_angle(&points, "motor"), distribution(&all, "motor")],
        ..Identification::default()
    })
}
