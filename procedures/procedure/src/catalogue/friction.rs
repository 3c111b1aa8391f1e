//! Friction over velocity, load, link angle and temperature.
//!
//! A repeat passes the loads from zero to the highest, so that the brake is always on its ascending branch. At its
//! end the brake is demagnetised during rotation. At each load the joint makes one *tour*: fast legs out in shuffled
//! order, the same speeds back in another order, and slow legs at shuffled places in between. A slow leg covers
//! little of a link turn, so that the tours distribute them over the link angle. The fastest leg covers a whole turn,
//! the next one a third. Order and places differ between tours, so that time, temperature and link angle are not
//! correlated with speed or load.
//!
//! The preceding warm-up is part of the table, as separate segments in repeat 0 (`warm_up_segments` of the meta facts
//! is their number). The temperature changes most there, which makes temperature effects identifiable.

use super::compensation;
use super::legs::{ACCELERATION, Legs, friction_meta, sample_rate, turn_s};
use super::warm_up;
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::findings::verdict;
use crate::identification::{FollowUp, Identification, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use crate::steady::SteadyCriterion;
use jointbench_instrument::{Kind, RunTable};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

mod free_friction;
mod identify;
mod inconclusive;

pub(super) struct Friction;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "friction",
    title: "Friction",
    summary: "Measures the torque at constant speeds, with more speeds near zero, in both directions and under several \
              loads. Speed, load, angle and temperature vary independently, so that missing effects can be identified.",
    kind: Kind::Friction,
    schema: &[
        Parameter::number("top_speed_rad_s", "Maximum speed (motor)", "rad/s", 180.0, [5.0, 1000.0]),
        Parameter::number("stribeck_speed_rad_s", "Expected Stribeck velocity (link)", "rad/s", 0.07, [0.001, 10.0]),
        Parameter::count("fast_speeds", "Number of speeds above the Stribeck velocity", 5, [2, 20]),
        Parameter::count("load_levels", "Load levels, including no load", 3, [1, 10]),
        Parameter::fraction("top_load", "Maximum brake current, relative to rated", 0.65, [0.05, 1.0]),
        Parameter::count("repeats", "Repeats of the profile", 2, [2, 50]),
        Parameter::number("dwell_s", "Dwell time at each speed", "s", 1.1, [0.3, 60.0]),
        Parameter::number("warm_up_s", "Maximum warm-up time", "s", 20.0, [1.0, 3600.0]),
        ACCELERATION,
        sample_rate(250.0),
        Parameter::count("order_seed", "Random seed (step order)", 1, [0, 1_000_000]),
    ],
};

/// Speeds below the expected Stribeck velocity, as shares of it: with fewer than four, its exponent is not identified
/// (diagnosis, pitfalls).
const SLOW_SHARES: [f64; 4] = [0.15, 0.3, 0.5, 0.75];
/// The lowest of the speeds above it, as a share.
const FAST_FROM: f64 = 1.3;
/// The torque of the brake grows slowly at first, so that even torques need uneven
/// currents.
const LOAD_EXPONENT: f64 = 0.7;

impl Procedure for Friction {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let speeds = Speeds::new(values, bench)?;
        let loads_a = loads(values, bench)?;
        let rate_hz = values.number("sample_rate_hz");
        let mut rng = ChaCha8Rng::seed_from_u64(u64::from(values.count("order_seed")));
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        warm_up::work(&mut legs, speeds.top_rad_s, values.number("warm_up_s"), bench);
        let warm_up_segments = legs.steps.len();
        for repeat in 0..values.count("repeats") {
            legs.repeat = repeat;
            let mut before_a = 0.0;
            for (level, brake_a) in loads_a.iter().copied().enumerate() {
                if brake_a > before_a {
                    legs.change(speeds.middle_rad_s(), before_a, brake_a);
                }
                let outwards = if (repeat as usize + level).is_multiple_of(2) { 1.0 } else { -1.0 };
                tour(&mut legs, &speeds, brake_a, outwards, &mut rng);
                before_a = brake_a;
            }
            if before_a > 0.0 {
                legs.unload(speeds.top_rad_s, before_a, bench);
            }
        }
        let mut meta = friction_meta(bench, rate_hz);
        meta.other.insert("warm_up_segments".into(), warm_up_segments.into());
        if loads_a.len() > 1 {
            let history = "each load approached from below, demagnetised while turning after each repeat";
            meta.other.insert("brake_history".into(), history.into());
        }
        Ok(Plan {
            steady: Some(SteadyCriterion {
                cycle_steps: warm_up::CYCLE_STEPS,
                temperature_c_per_min: 0.3,
                current_share_per_min: 0.01,
            }),
            ..legs.plan(self, values, meta, rate_hz)
        })
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[
            (
                "Nm",
                "tau_c tau_h tau_c_positive tau_h_positive tau_c_negative tau_h_negative tau_c_difference tau_s_most",
            ),
            ("Nm·s/rad", "c_v c_v_positive c_v_negative c_v_difference"),
            ("rad/s", "omega_s omega_s_positive omega_s_negative"),
            ("", "delta_s delta_s_positive delta_s_negative r2_positive r2_negative"),
        ])
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify::identify(values.number("stribeck_speed_rad_s"), run))
    }

    fn follow_up(&self, found: &Identification) -> Option<FollowUp> {
        (found.verdict == Verdict::Identified).then(|| compensation::of_friction(found)).flatten()
    }
}

/// The speeds of a tour, motor side, with the dwell time at each.
struct Speeds {
    slow: Vec<(f64, f64)>,
    fast: Vec<(f64, f64)>,
    top_rad_s: f64,
}

impl Speeds {
    fn new(values: &Values, bench: &BenchFacts) -> Result<Self, PlanFault> {
        let stribeck_rad_s = values.number("stribeck_speed_rad_s") * bench.constants.gear_ratio;
        let (top_rad_s, dwell_s) = (values.number("top_speed_rad_s"), values.number("dwell_s"));
        let from_rad_s = FAST_FROM * stribeck_rad_s;
        if top_rad_s < 2.0 * from_rad_s {
            return Err(PlanFault::Contradiction {
                what: format!(
                    "top_speed_rad_s = {top_rad_s} is too close to the Stribeck velocity, {stribeck_rad_s:.1} rad/s \
                     (motor)"
                ),
                cure: "increase top_speed_rad_s or reduce stribeck_speed_rad_s",
            });
        }
        let count = values.count("fast_speeds");
        let fast = |i: u32| {
            let speed_rad_s = from_rad_s * (top_rad_s / from_rad_s).powf(f64::from(i) / f64::from(count - 1));
            let turn_share = match count - 1 - i {
                0 => 1.0,
                1 => 1.0 / 3.0,
                _ => 0.0,
            };
            (speed_rad_s, turn_s(turn_share, speed_rad_s, bench, dwell_s))
        };
        Ok(Self {
            slow: SLOW_SHARES.iter().map(|share| (share * stribeck_rad_s, dwell_s)).collect(),
            fast: (0..count).map(fast).collect(),
            top_rad_s,
        })
    }

    /// Speed for a change of load: fast enough to turn, slow enough to stay near.
    fn middle_rad_s(&self) -> f64 {
        self.fast[self.fast.len() / 2].0
    }
}

/// Brake currents in rising order, the first 0.
fn loads(values: &Values, bench: &BenchFacts) -> Result<Vec<f64>, PlanFault> {
    let levels = values.count("load_levels");
    if levels > 1 {
        bench.check_load(match bench.amperes_per_volt {
            Some(_) => "use puma_friction for the axis of an arm",
            None => "set load_levels = 1, or connect it",
        })?;
    }
    let top_a = values.number("top_load") * bench.constants.brake_rated_current_a;
    let share = |level: u32| f64::from(level) / f64::from((levels - 1).max(1));
    Ok((0..levels).map(|level| top_a * share(level).powf(LOAD_EXPONENT)).collect())
}

fn tour(legs: &mut Legs, speeds: &Speeds, brake_a: f64, outwards: f64, rng: &mut ChaCha8Rng) {
    for direction in [outwards, -outwards] {
        let mut fast = speeds.fast.clone();
        fast.shuffle(rng);
        // The first leg of a half winds up the joint after the reversal, so that it must not be the slowest one.
        if fast[0] == speeds.fast[0] {
            fast.reverse();
        }
        // Slow leg number i follows fast leg `places[i]`.
        let mut places: Vec<usize> = (0..fast.len()).collect();
        places.shuffle(rng);
        for (place, (speed_rad_s, dwell_s)) in fast.into_iter().enumerate() {
            legs.leg(direction * speed_rad_s, dwell_s, brake_a);
            for number in (0..speeds.slow.len()).filter(|number| places[number % places.len()] == place) {
                slow(legs, speeds, number, brake_a, direction, outwards);
            }
        }
    }
}

/// Without load a slow leg is a pair, out and back, at every other place, so that reversals are close to each other.
/// Under load the wind-up of joint and brake lasts longer than a reversed slow leg (0.04 rad of the link). Therefore
/// each direction is measured in its half of the tour.
fn slow(legs: &mut Legs, speeds: &Speeds, number: usize, brake_a: f64, direction: f64, outwards: f64) {
    let (speed_rad_s, dwell_s) = speeds.slow[number];
    if brake_a > 0.0 {
        legs.leg(direction * speed_rad_s, dwell_s, brake_a);
    } else if number.is_multiple_of(2) == (direction == outwards) {
        legs.leg(direction * speed_rad_s, dwell_s, brake_a);
        legs.leg(-direction * speed_rad_s, dwell_s, brake_a);
    }
}

#[cfg(test)]
mod tests;
