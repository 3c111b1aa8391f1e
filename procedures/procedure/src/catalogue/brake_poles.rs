//! Magnetic poles that a brake keeps after its current has fallen at standstill.
//!
//! The run magnetises the demagnetised brake at standstill. Slow turns without current show its torque over the angle;
//! then the brake is demagnetised while it turns, and the same turns are repeated. A ripple that the joint, the
//! coupling or the sensor causes is in both measurements, so that only orders that demagnetising changes are poles.

use super::brake_run;
use super::legs::{ACCELERATION, Legs, sample_rate};
use super::remanence;
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::brake_timing::{LAG_S, RAISE_S};
use crate::findings::verdict;
use crate::identification::Identification;
use crate::parameter::{Parameter, Values};
use crate::plan::{BrakeControl, InitialState, Plan, PlanFault};
use crate::profile::Profile;
use jointbench_instrument::{Kind, RunTable};
use std::f64::consts::TAU;

mod identify;
mod ripple;

pub(super) struct BrakePoles;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "brake_poles",
    title: "Cogging poles of the brake",
    summary: "Magnetises the brake at standstill and measures the torque over slow turns without current: number of \
              poles and their torque. Then demagnetises the brake and measures again.",
    kind: Kind::Brake,
    schema: &[
        Parameter::fraction("top_current", "Magnetising current, relative to rated", 1.0, [0.05, 1.0]),
        Parameter::number("speed_rad_s", "Speed of the measured turns (brake)", "rad/s", 0.4, [0.02, 5.0]),
        Parameter::count("repeats", "Measured turns in each direction, before and after", 3, [2, 20]),
        Parameter::number("demagnetise_speed_rad_s", "Speed of demagnetising (link)", "rad/s", 1.5, [0.2, 20.0]),
        Parameter::number("demagnetise_turns", "Link turns while the current decreases", "", 3.0, [1.0, 20.0]),
        ACCELERATION,
        sample_rate(250.0),
    ],
};

/// Turns of a measured leg: one is evaluated, and the rotor winds up before it.
const TURNS: f64 = 1.2;

/// Time at the magnetising current: 0.1 % of the last step of the ramp is left after 0.12 s of supply and 7 · 0.08 s of
/// coil, and as much again for slower coils.
const MAGNETISE_S: f64 = 1.5;

/// Purpose of a leg, stored in the column `repeat`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Prepare,
    Magnetised,
    Checked,
    Demagnetised,
}

impl Procedure for BrakePoles {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn is_modelled(&self) -> bool {
        false
    }

    fn can_resume(&self) -> Result<(), &'static str> {
        Err("the brake is demagnetised before a run is resumed")
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        brake_run::check(bench)?;
        let rate_hz = values.number("sample_rate_hz");
        let of_motor = |name: &str| values.number(name) * bench.constants.gear_ratio;
        let top_a = values.number("top_current") * bench.constants.brake_rated_current_a;
        let fast_rad_s = of_motor("demagnetise_speed_rad_s").min(0.95 * bench.limits.motor_velocity_rad_s);
        let turns = values.number("demagnetise_turns");
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        let slow_rad_s = of_motor("speed_rad_s") / bench.constants.load_gear_ratio.unwrap_or(1.0);
        let measure = |legs: &mut Legs, part: Part| {
            legs.repeat = part as u32;
            for _ in 0..values.count("repeats") {
                legs.leg(slow_rad_s, TURNS * TAU / values.number("speed_rad_s"), 0.0);
                legs.leg(-slow_rad_s, TURNS * TAU / values.number("speed_rad_s"), 0.0);
            }
            legs.repeat = Part::Prepare as u32;
        };
        legs.demagnetise(fast_rad_s, top_a, turns, bench);
        magnetise(&mut legs, top_a);
        measure(&mut legs, Part::Magnetised);
        remanence::demagnetise(&mut legs, fast_rad_s, top_a, turns, Part::Checked as u32, bench);
        measure(&mut legs, Part::Demagnetised);
        Ok(legs.plan(self, values, brake_run::meta(bench, rate_hz), rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[("", "poles"), ("Nm", "amplitude amplitude_after amplitude_most left noise")])
    }

    fn identify(&self, _: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify::identify(run))
    }
}

/// The current rises and falls at standstill.
fn magnetise(legs: &mut Legs, top_a: f64) {
    let brake = Profile::from(0.0).to(top_a, RAISE_S).hold(MAGNETISE_S).to(0.0, RAISE_S).hold(LAG_S);
    legs.push("magnetise the brake at standstill".into(), Profile::from(0.0).hold(brake.duration_s()), brake);
    if let Some(step) = legs.steps.last_mut() {
        (step.before, step.brake_control) = (InitialState::Demagnetised, BrakeControl::Magnetise);
    }
}

#[cfg(test)]
mod tests {
    use super::super::legs::testing::{joint_a, joint_b};
    use super::*;
    use serde_json::Map;

    #[test]
    fn only_the_magnetising_step_lets_the_current_fall_at_standstill_and_the_run_ends_clean() {
        for bench in [joint_a(), joint_b()] {
            let plan = BrakePoles.plan(&Map::new(), &bench).unwrap();
            assert!(plan.preview(&bench).is_allowed(), "{:?}", plan.preview(&bench).checks);
            let magnetising: Vec<usize> = (0..plan.steps.len())
                .filter(|step| plan.steps[*step].brake_control == BrakeControl::Magnetise)
                .collect();
            let [at] = magnetising[..] else { panic!("{magnetising:?}") };
            let step = &plan.steps[at];
            assert_eq!((step.velocity.largest(), step.brake.largest(), step.brake.end()), (0.0, 0.6, 0.0));
            let check = |plan: &Plan| {
                let checks = plan.preview(&bench).checks;
                checks.into_iter().find(|check| check.name == "magnetisation").map(|check| check.ok)
            };
            assert_eq!(check(&plan), Some(true));
            let unfinished = Plan { steps: plan.steps[..=at].to_vec(), ..plan };
            assert_eq!(check(&unfinished), Some(false), "magnetised and left so");
        }
    }
}
