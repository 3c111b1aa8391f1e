//! Removes magnetic poles from a brake that was unloaded at standstill, and checks the result.

use super::brake_run;
use super::legs::{ACCELERATION, Legs, sample_rate};
use super::remanence::{self, Remanence};
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::findings::{Hold, Unusable, holds, verdict};
use crate::identification::{Figure, Identification, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use jointbench_instrument::{Kind, RunTable};

pub(super) struct Demagnetise;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "demagnetise",
    title: "Demagnetise the brake",
    summary: "Magnetises the brake fully, then reduces the current to zero while the shaft turns. One turn without \
              current measures the remanent torque.",
    kind: Kind::Brake,
    schema: &[
        Parameter::number("speed_rad_s", "Speed (link)", "rad/s", 1.5, [0.2, 20.0]),
        Parameter::number("turns", "Link turns while the current decreases", "", 3.0, [1.0, 20.0]),
        Parameter::fraction("top_current", "Initial current, relative to rated", 1.0, [0.05, 1.0]),
        ACCELERATION,
        sample_rate(250.0),
    ],
};

/// The turns that are measured, in the column `repeat`.
const MEASURED: u32 = 1;

impl Procedure for Demagnetise {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn is_modelled(&self) -> bool {
        false
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        brake_run::check(bench)?;
        let rate_hz = values.number("sample_rate_hz");
        let speed_rad_s =
            (values.number("speed_rad_s") * bench.constants.gear_ratio).min(0.95 * bench.limits.motor_velocity_rad_s);
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        let top_a = values.number("top_current") * bench.constants.brake_rated_current_a;
        remanence::demagnetise(&mut legs, speed_rad_s, top_a, values.number("turns"), MEASURED, bench);
        Ok(legs.plan(self, values, brake_run::meta(bench, rate_hz), rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[("Nm", "left noise")])
    }

    fn identify(&self, _: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(run))
    }
}

fn identify(run: &RunTable) -> Result<Identification, Unusable> {
    const LITTLE: Unusable = Unusable::InsufficientData("The run ended before the last turn.", "Repeat the run.");
    let holds: Vec<Hold> =
        holds(run, 0.5).into_iter().filter(|hold| hold.repeat == i64::from(MEASURED)).take(2).collect();
    let remanence = Remanence::of(run, &holds).filter(|_| holds.len() == 2).ok_or(LITTLE)?;
    let clean = remanence.is_clean();
    Ok(Identification {
        verdict: if clean { Verdict::Identified } else { Verdict::Inconclusive },
        summary: remanence.sentence(),
        advice: (!clean)
            .then(|| "The rotor is still magnetised. Increase the number of turns or the initial current.".into()),
        quantities: remanence.quantities(),
        figures: vec![Figure {
            series: vec![remanence.series(0, "out"), remanence.series(1, "back")],
            ..remanence::over_angle("Torque without current over one turn")
        }],
        ..Identification::default()
    })
}
