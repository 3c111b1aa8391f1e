//! Stiction of the transmission between torque sensor and brake: the motor current rises until the shaft moves.
//!
//! The torque sensor between joint and transmission measures the torque at which the transmission breaks away, so that
//! friction of the joint has no influence. The joint winds up before: its motor creeps while the torque rises. A
//! transmission whose friction falls with speed then accelerates, which ends the ramp. The torque includes the drag of
//! brakes without current. The zero of the sensor adds to one direction and reduces the other, so that the mean is free
//! of it.

use super::breakaway::ramps::{Ramps, is_held, ramps};
use super::breakaway::torques::{BreakawayPoint, Torques, distribution, over_angle};
use super::legs::{ACCELERATION, Legs, sample_rate};
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::findings::{Unusable, verdict};
use crate::identification::{Identification, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{EndCondition, Plan, PlanFault};
use crate::thresholds::JOLT;
use jointbench_instrument::{Kind, RunTable};
use std::f64::consts::TAU;
use std::ops::Range;

pub(super) struct TransmissionBreakaway;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "transmission_breakaway",
    title: "Breakaway of the transmission",
    summary: "Ramps the motor current until the load gear behind the torque sensor breaks away, at several positions \
              and in both directions. The torque sensor gives the breakaway torque without the friction of the joint.",
    kind: Kind::Friction,
    schema: &[
        Parameter::count("positions", "Number of positions in each direction", 8, [2, 100]),
        Parameter::number("arc_rad", "Arc of the positions (link)", "rad", TAU, [0.02, TAU]),
        Parameter::number(
            "top_torque_nm",
            "Maximum torque of the ramp, friction of the joint included (link)",
            "Nm",
            15.0,
            [0.1, 1000.0],
        ),
        Parameter::number("ramp_nm_s", "Torque ramp rate (link)", "Nm/s", 1.0, [0.01, 5.0]),
        Parameter::number("speed_rad_s", "Approach speed (motor)", "rad/s", 60.0, [1.0, 1000.0]),
        ACCELERATION,
        sample_rate(250.0),
    ],
};

/// End of a ramp: by speed alone. Counts increase in a row before the breakaway too, while joint and teeth yield. After
/// its own stiction a joint winds up by less than 0.1 rad (motor), at less than half of this speed.
const UNTIL: EndCondition = EndCondition { increases: u32::MAX, speed_rad_s: 20.0 };
/// The motor that runs away is at least this fast at the end of its ramp; a ramp that a pause interrupted is not.
const MOVING_RAD_S: f64 = 0.5 * UNTIL.speed_rad_s;
/// The breakaway torque is the largest mean over this time, so that it is not the largest noise (s).
const MEAN_S: f64 = 0.04;

/// A torque that rises in this time by more than twice its ramp and [`JOLT`] has a dynamic part: a joint with more
/// stiction than friction moves with a jolt.
const JOLT_S: f64 = 0.1;
const WHAT: &str = "Breakaway torque of the transmission";

impl Procedure for TransmissionBreakaway {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn is_modelled(&self) -> bool {
        false
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        if bench.constants.load_gear_ratio.is_none() {
            let cure = "state load_gear_ratio in [bench.constants], or run breakaway to measure the joint";
            return Err(bench.missing("load gear", cure));
        }
        if !bench.has_torque_sensor {
            return Err(bench.missing("torque sensor", "connect it"));
        }
        let (rate_hz, top_nm) = (values.number("sample_rate_hz"), values.number("top_torque_nm"));
        if top_nm > bench.limits.link_torque_nm {
            return Err(PlanFault::Contradiction {
                what: format!(
                    "top_torque_nm = {top_nm} exceeds the link torque limit of {} Nm",
                    bench.limits.link_torque_nm
                ),
                cure: "set top_torque_nm to this limit or less",
            });
        }
        let ramps = Ramps {
            positions: values.count("positions"),
            arc_rad: values.number("arc_rad"),
            speed_rad_s: values.number("speed_rad_s"),
            top_a: top_nm / bench.constants.gear_ratio / bench.constants.torque_constant_nm_per_a,
            ramp_s: top_nm / values.number("ramp_nm_s"),
            until: UNTIL,
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
    const FOREIGN: Unusable = Unusable::InsufficientData(
        "The run has no motor current set-point or no torque, so it belongs to another procedure.",
        "Run transmission_breakaway.",
    );
    let column = |name: &str| run.column(name).ok_or(FOREIGN);
    let (setpoint_a, velocity) = (column("motor_current_setpoint_a")?, column("motor_velocity_rad_s")?);
    let (torque_nm, motor_rad) = (column("link_torque_nm")?, column("motor_position_rad")?);
    let [km, gear] = [run.meta().torque_constant_nm_per_a, run.meta().gear_ratio].map(|known| known.unwrap_or(1.0));
    let link = |row: usize| run.column("link_position_rad").map_or(motor_rad[row] / gear, |link| link[row]);
    let top_a = values.number("top_torque_nm") / gear / km;
    let [rate_hz, ramp_nm_s] = ["sample_rate_hz", "ramp_nm_s"].map(|name| values.number(name));
    let (held, moved): (Vec<_>, Vec<_>) =
        ramps(run, setpoint_a).into_iter().partition(|ramp| is_held(ramp, setpoint_a, top_a));
    let [width, rise] = [MEAN_S, JOLT_S].map(|seconds| (seconds * rate_hz) as usize);
    let mut jolts = 0;
    let point = |ramp: Range<usize>| {
        let sign = setpoint_a[ramp.end - 1].signum();
        let torque: Vec<f64> =
            ramp.clone().filter(|row| setpoint_a[*row] != 0.0).map(|row| sign * torque_nm[row]).collect();
        let means: Vec<f64> = torque.windows(width).map(|some| some.iter().sum::<f64>() / width as f64).collect();
        let (peak, torque_nm) = means.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let risen_nm = torque_nm - means[peak.saturating_sub(rise)];
        let is_moving = sign * velocity[ramp.end - 1] >= MOVING_RAD_S;
        jolts += u32::from(is_moving && risen_nm > 2.0 * JOLT_S * ramp_nm_s + JOLT * torque_nm);
        is_moving.then(|| BreakawayPoint { link_rad: link(ramp.end - 1).rem_euclid(TAU), torque_nm, sign })
    };
    let points: Vec<BreakawayPoint> = moved.into_iter().filter_map(point).collect();
    let Some(torques) = Torques::of(&points, ramp_nm_s / rate_hz) else {
        let advice = "Increase top_torque_nm: it includes the friction of the joint times its gear ratio.";
        return Err(Unusable::InsufficientData("Too few breakaway events.", advice));
    };
    let all: Vec<f64> = points.iter().map(|point| point.torque_nm).collect();
    let advice = match (held.len(), jolts) {
        (0, 0) => None,
        (0, _) => Some(format!(
            "The joint itself broke away with a jolt at {jolts} positions, which adds inertia: the breakaway torque of \
             the transmission is at most this value. Repeat with a joint of less stiction or a stiffer gear."
        )),
        (held, _) => Some(format!("The transmission did not break away at {held} positions. Increase top_torque_nm.")),
    };
    Ok(Identification {
        verdict: if advice.is_none() { Verdict::Identified } else { Verdict::Inconclusive },
        summary: torques.sentence(WHAT, "at the torque sensor", all.len()),
        advice,
        quantities: torques.quantities(WHAT),
        figures: vec![over_angle(&points, "transmission"), distribution(&all, "transmission")],
        ..Identification::default()
    })
}

#[cfg(test)]
mod tests {
    use super::super::legs::testing::{joint_a, joint_b};
    use super::*;
    use serde_json::{Map, json};

    #[test]
    fn a_bench_without_gear_or_sensor_is_refused_and_limits_are_kept() {
        let refusal = |bench: &BenchFacts, given: serde_json::Value| {
            TransmissionBreakaway.plan(given.as_object().unwrap(), bench).unwrap_err().to_string()
        };
        let mut bench = joint_a();
        assert_eq!(
            refusal(&bench, json!({})),
            "bench a has no load gear: state load_gear_ratio in [bench.constants], or run breakaway to measure the joint"
        );
        bench.constants.load_gear_ratio = Some(10.0);
        assert!(refusal(&bench, json!({"top_torque_nm": 20.0})).contains("exceeds the link torque limit of 18 Nm"));
        bench.has_torque_sensor = false;
        assert_eq!(refusal(&bench, json!({})), "bench a has no torque sensor: connect it");
        for mut bench in [joint_a(), joint_b()] {
            bench.constants.load_gear_ratio = Some(10.0);
            let plan = TransmissionBreakaway.plan(&Map::new(), &bench).unwrap();
            assert!(plan.preview(&bench).is_allowed(), "{:?}", plan.preview(&bench).checks);
        }
    }
}
