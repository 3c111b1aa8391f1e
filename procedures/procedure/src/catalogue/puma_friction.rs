//! Friction of an arm's axis by the method of Corke 1994, section 3.1. A work-out comes first. Then the mean motor
//! current is measured at constant speeds over a short arc around the pose without gravity torque. The results are a
//! line for each direction, their mean viscous friction, a test for a difference of the directions, and stiction. For
//! stiction the current rises until the encoder increases five times in a row.
//!
//! The run begins at the encoder position 0, with the link upright. Every speed is held over the same arc in both
//! directions, from end to end. The remaining gravity torque is then the same in both, with a zero mean.
//!
//! The document's stiction is the current of the first increase. The joint creeps before its encoder shows it, while
//! the current still rises. The figure therefore exceeds the friction at rest. On the mock bench the excess is 1.0 to
//! 3.1 % at the default ramp (30 arms), and 2.1 to 5.7 % at three times the ramp (20 arms). Its interval is the
//! scatter between tries and one step of the ramp.

use super::breakaway::ramps::{REST_S, RUNAWAY_RAD_S};
use super::legs::{ACCELERATION, Legs, friction_meta, stroke};
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::findings::verdict;
use crate::identification::Identification;
use crate::parameter::{Parameter, Values};
use crate::plan::{Drive, EndCondition, Phase, Plan, PlanFault};
use crate::profile::Profile;
use crate::steady::SteadyCriterion;
use jointbench_instrument::{Kind, RunTable};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

mod identify;

pub(super) struct PumaFriction;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "puma_friction",
    title: "Robot-arm friction (Puma)",
    summary: "Warms up the axis, then measures the mean shunt voltage at constant speeds over a short arc about the \
              upright pose. Fits a line for each direction and measures breakaway friction. Set the link upright \
              first.",
    kind: Kind::Friction,
    schema: &[
        Parameter::number("lowest_speed_rad_s", "Minimum speed (link)", "rad/s", 0.0873, [0.001, 10.0]),
        Parameter::number("top_speed_rad_s", "Maximum speed (link)", "rad/s", 0.698, [0.01, 20.0]),
        Parameter::count("speeds", "Number of speeds in each direction", 8, [3, 40]),
        Parameter::number("arc_rad", "Arc to either side of the upright pose (link)", "rad", 0.45, [0.02, 3.0]),
        Parameter::count("repeats", "Repeats of the profile", 3, [1, 50]),
        Parameter::number("warm_up_s", "Maximum warm-up time", "s", 60.0, [1.0, 3600.0]),
        Parameter::count("breakaways", "Breakaway measurements in each direction", 4, [2, 50]),
        Parameter::number("top_torque_nm", "Maximum torque of the ramp (motor)", "Nm", 0.3, [1e-3, 100.0]),
        Parameter::number("ramp_nm_s", "Torque ramp rate (motor)", "Nm/s", 0.02, [1e-4, 10.0]),
        Parameter::count("increases", "Consecutive encoder increments", 5, [2, 50]),
        ACCELERATION,
        Parameter::number("sample_rate_hz", "Control and sample rate", "Hz", 100.0, [40.0, 500.0]),
        Parameter::count("order_seed", "Random seed (step order)", 1, [0, 1_000_000]),
    ],
};

/// Strokes of one work-out cycle whose currents are compared: two out, two back.
const CYCLE_STEPS: usize = 4;
/// Distance of the approach (link), so that the joint arrives in the direction of the ramp.
const BACK_OFF_RAD: f64 = 0.02;
/// Motor speed of motions that are not measured.
const MOVE_SHARE: f64 = 0.5;
/// Shortest settling time at a constant speed. A position servo whose set-point is renewed before it is reached settles
/// exponentially with the set-point interval: after this number of intervals to 0.1 %.
const SETTLE_S: f64 = 0.2;
const SETTLE_INTERVALS: f64 = 7.0;

impl Procedure for PumaFriction {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn can_resume(&self) -> Result<(), &'static str> {
        Err("its arc is centred on the initial pose: set the link upright and repeat the run")
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let Some(amperes_per_volt) = bench.amperes_per_volt else {
            return Err(PlanFault::Contradiction {
                what: format!("bench {} does not measure the motor current as shunt voltage", bench.name),
                cure: "run friction and breakaway instead",
            });
        };
        let gear = bench.constants.gear_ratio;
        let rate_hz = values.number("sample_rate_hz");
        let acceleration_rad_s2 = values.number("acceleration_rad_s2");
        let speeds: Vec<f64> = speeds(values)?.map(|speed_rad_s| gear * speed_rad_s).collect();
        let top_rad_s = speeds[speeds.len() - 1];
        let arc_rad = gear * values.number("arc_rad");
        let interval_s = bench.setpoint_interval.map(|interval| interval.duration_s());
        let settle_s = settling_s(interval_s);
        // The joint has accelerated and settled when it passes the upright pose.
        let most_rad_s =
            acceleration_rad_s2 * (settle_s.hypot((2.0 * arc_rad / acceleration_rad_s2).sqrt()) - settle_s);
        if top_rad_s > most_rad_s {
            let (given, most) = (values.number("top_speed_rad_s"), (1e3 * most_rad_s / gear).floor() / 1e3);
            return Err(PlanFault::Contradiction {
                what: format!("top_speed_rad_s = {given} cannot be held on this arc, {most} can"),
                cure: "reduce it, or increase arc_rad or acceleration_rad_s2",
            });
        }
        let mut legs = Legs::new(acceleration_rad_s2);
        go(&mut legs, "to the end of the arc".into(), -arc_rad, MOVE_SHARE * top_rad_s);
        work_out(&mut legs, arc_rad, top_rad_s, values.number("warm_up_s"));
        let first = legs.steps.len();
        measure(&mut legs, values, gear, arc_rad, speeds);
        let lines = legs.steps.len() - first;
        go(&mut legs, "to the upright pose".into(), arc_rad, MOVE_SHARE * top_rad_s);
        break_away(&mut legs, values, bench);
        let mut meta = friction_meta(bench, rate_hz);
        meta.other.insert("warm_up_segments".into(), first.into());
        meta.other.insert("line_segments".into(), lines.into());
        meta.other.insert("segments".into(), legs.steps.len().into());
        meta.other.insert("amperes_per_volt".into(), amperes_per_volt.into());
        meta.other.insert("setpoint_interval_s".into(), interval_s.into());
        Ok(Plan {
            steady: Some(SteadyCriterion {
                cycle_steps: CYCLE_STEPS,
                temperature_c_per_min: 0.3,
                current_share_per_min: 0.05,
            }),
            ..legs.plan(self, values, meta, rate_hz)
        })
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[
            ("V", "f_positive f_negative f_difference weight stiction_positive stiction_negative"),
            ("V/(°/s)", "b_positive b_negative b_mean b_difference"),
            ("", "r2_positive r2_negative"),
            ("Nm", "tau_c_positive tau_c_negative tau_s_positive tau_s_negative"),
            ("Nm·s/rad", "c_v_positive c_v_negative c_v_mean"),
        ])
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify::identify(values, run))
    }
}

/// Settling time at a constant speed (s).
fn settling_s(interval_s: Option<f64>) -> f64 {
    SETTLE_S.max(SETTLE_INTERVALS * interval_s.unwrap_or(0.0))
}

/// Link side, evenly from the lowest to the highest.
fn speeds(values: &Values) -> Result<impl Iterator<Item = f64> + use<>, PlanFault> {
    let (low, top) = (values.number("lowest_speed_rad_s"), values.number("top_speed_rad_s"));
    if top < 2.0 * low {
        return Err(PlanFault::Contradiction {
            what: format!("top_speed_rad_s = {top} is too close to lowest_speed_rad_s = {low}"),
            cure: "the speed range is too small for a line, increase the one or reduce the other",
        });
    }
    let count = values.count("speeds");
    Ok((0..count).map(move |i| low + (top - low) * f64::from(i) / f64::from(count - 1)))
}

/// A motion by `way_rad` of the motor without brake current.
fn go(legs: &mut Legs, label: String, way_rad: f64, speed_rad_s: f64) {
    legs.push(label, stroke(way_rad, speed_rad_s, legs.acceleration_rad_s2), Profile::constant(0.0));
}

/// Whole cycles over the arc (motor) for at least `least_s`.
fn work_out(legs: &mut Legs, arc_rad: f64, top_rad_s: f64, least_s: f64) {
    legs.phase = Phase::WarmUp;
    let mut work_s = 0.0;
    while work_s < least_s {
        for sign in [1.0, -1.0, 1.0, -1.0] {
            go(legs, "work-out".into(), 2.0 * sign * arc_rad, top_rad_s);
            work_s += legs.steps.last().map_or(0.0, crate::plan::Step::duration_s);
        }
    }
    legs.phase = Phase::Measure;
}

/// Every motor speed over the arc (motor) in both directions, in a new order for each repeat.
fn measure(legs: &mut Legs, values: &Values, gear: f64, arc_rad: f64, mut speeds: Vec<f64>) {
    let mut rng = ChaCha8Rng::seed_from_u64(u64::from(values.count("order_seed")));
    for repeat in 0..values.count("repeats") {
        legs.repeat = repeat;
        speeds.shuffle(&mut rng);
        for speed_rad_s in &speeds {
            let shown = (speed_rad_s / gear).to_degrees();
            for sign in [1.0, -1.0] {
                go(legs, format!("{:+.1} °/s", sign * shown), 2.0 * sign * arc_rad, *speed_rad_s);
            }
        }
    }
}

/// Stiction at the upright pose; the joint arrives in the direction in which it will break away.
fn break_away(legs: &mut Legs, values: &Values, bench: &BenchFacts) {
    let top_a = values.number("top_torque_nm") / bench.constants.torque_constant_nm_per_a;
    let ramp_s = values.number("top_torque_nm") / values.number("ramp_nm_s");
    let until = EndCondition { increases: values.count("increases"), speed_rad_s: RUNAWAY_RAD_S };
    let back_rad = BACK_OFF_RAD * bench.constants.gear_ratio;
    let count = values.count("breakaways");
    for (repeat, sign) in [(0, 1.0), (1, -1.0)] {
        legs.repeat = repeat;
        for number in 1..=count {
            let back = stroke(-sign * back_rad, RUNAWAY_RAD_S, legs.acceleration_rad_s2);
            let there = stroke(sign * back_rad, RUNAWAY_RAD_S, legs.acceleration_rad_s2);
            let velocity = back.then(&there);
            let from_s = velocity.duration_s() + REST_S;
            let way = if sign > 0.0 { "forward" } else { "backward" };
            legs.push(format!("breakaway {way}, {number} of {count}"), velocity, Profile::constant(0.0));
            let current_a = Profile::from(0.0).hold(REST_S).to(sign * top_a, ramp_s);
            legs.drive_of_last(Drive::Current { from_s, current_a, until });
        }
    }
    // The velocity loop stops the joint after the last breakaway before the run ends.
    legs.push("rest".into(), Profile::from(0.0).hold(REST_S), Profile::constant(0.0));
}

#[cfg(test)]
mod tests;
