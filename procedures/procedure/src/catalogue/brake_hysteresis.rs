//! Torque of a brake over its current and its whole current history.
//!
//! The run demagnetises the brake first. Then it measures the major loop, first-order reversal curves from every
//! current of a grid down to zero, and nested minor loops. A random history is left out of the model and validates
//! it. Each of these is one uninterrupted step at constant speed. It starts and ends at zero current, because a fall
//! to zero during rotation erases the history.
//!
//! The model is the Preisach model in Everett's form. The reversal curves measure the torque reduction by a fall
//! between two currents. Every history is a sum of such falls and rises (Mayergoyz, *Mathematical Models of
//! Hysteresis*, chapter 1). No function shape is assumed. The inverse gives the current for a torque after any
//! history.
//!
//! With the run of another brake, the result contains the difference between both brakes: of the torque that the
//! current adds, at the shaft of the brake.

mod compare;
mod identify;

use super::brake_run;
use super::legs::{ACCELERATION, Legs, sample_rate};
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::brake_model::{BrakeModel, ComparedBrake};
use crate::findings::verdict;
use crate::identification::Identification;
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
pub(super) use identify::{BOUND, SETTLED};
use jointbench_instrument::{Kind, RunTable};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub(super) struct BrakeHysteresis;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "brake_hysteresis",
    title: "Brake hysteresis",
    summary: "Measures the major loop, minor loops and reversal curves of the brake. Identifies a hysteresis model and \
              its inverse, which gives the current for a torque after any history. Optionally compares two brakes.",
    kind: Kind::Brake,
    schema: &[
        Parameter::count("levels", "Current levels", 20, [4, 40]),
        Parameter::count("loops", "Major loops", 2, [1, 20]),
        Parameter::count("random_turns", "Reversals of the random history", 16, [4, 100]),
        Parameter::fraction("top_current", "Maximum current, relative to rated", 1.0, [0.05, 1.0]),
        Parameter::number("dwell_s", "Dwell time at each current", "s", 0.9, [0.5, 20.0]),
        Parameter::number("speed_rad_s", "Speed (link)", "rad/s", 1.5, [0.2, 20.0]),
        ACCELERATION,
        sample_rate(100.0),
        Parameter::count("order_seed", "Random seed (history)", 1, [0, 1_000_000]),
        Parameter::count(
            "compare_run",
            "Run of brake_hysteresis of another brake to compare with (0: none)",
            0,
            [0, 2_000_000_000],
        ),
    ],
};

/// Purpose of a sweep, stored in the column `repeat`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Demagnetise,
    Major,
    Reversal,
    Minor,
    Random,
}

impl Procedure for BrakeHysteresis {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        brake_run::check(bench)?;
        let rate_hz = values.number("sample_rate_hz");
        let top_a = values.number("top_current") * bench.constants.brake_rated_current_a;
        let mut meta = brake_run::meta(bench, rate_hz);
        if values.count("compare_run") > 0 {
            compare::add_to(&mut meta, bench, top_a)?;
        }
        let sweeps = sweeps(values, top_a);
        let dwell_s = values.number("dwell_s");
        let longest_s = sweeps.iter().map(|(_, _, currents)| (currents.len() + 2) as f64 * dwell_s).fold(0.0, f64::max);
        let wanted_rad_s =
            (values.number("speed_rad_s") * bench.constants.gear_ratio).min(0.95 * bench.limits.motor_velocity_rad_s);
        let speed_rad_s = brake_run::speed_rad_s(wanted_rad_s, longest_s, bench);
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        legs.repeat = Part::Demagnetise as u32;
        legs.demagnetise(wanted_rad_s, top_a, 2.0, bench);
        // Each sweep turns towards the position where the first one began.
        let mut way_rad = 0.0;
        for (part, label, currents) in &sweeps {
            legs.repeat = *part as u32;
            let sign = if way_rad > 0.0 { -1.0 } else { 1.0 };
            legs.sweep(label.clone(), sign * speed_rad_s, currents, dwell_s);
            way_rad += legs.way_of_last();
        }
        legs.repeat = Part::Demagnetise as u32;
        legs.way_back(way_rad, speed_rad_s);
        Ok(legs.plan(self, values, meta, rate_hz))
    }

    fn compared_brake(&self, values: &Values) -> Option<u32> {
        Some(values.count("compare_run")).filter(|run| *run > 0)
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[
            ("Nm", "torque_top width drag difference_mean difference_top"),
            ("", "model_currents"),
            ("%", "error_max error_rms error_line difference_max"),
            ("A", "current_error"),
        ])
    }

    fn identify(&self, _: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify::identify(run))
    }
}

/// The model from a run of this procedure; `None` if the run ended too early.
pub fn brake_model(run: &RunTable) -> Option<BrakeModel> {
    run.column("brake_torque_nm")?;
    identify::model(run).ok()
}

/// The brake of a run of this procedure, for comparison with another one; `None` if the run ended too early.
pub fn compared_brake(run: &RunTable) -> Option<ComparedBrake> {
    run.column("brake_torque_nm")?;
    let (model, error_nm) = identify::model_with_error(run)?;
    Some(ComparedBrake { model, error_nm, gear_ratio: brake_run::load_gear_ratio(run) })
}

/// The currents of every sweep, each from 0 and back to 0.
fn sweeps(values: &Values, top_a: f64) -> Vec<(Part, String, Vec<f64>)> {
    let levels = values.count("levels");
    let grid = |level: u32| top_a * f64::from(level) / f64::from(levels);
    let up_and_down = |top: u32| -> Vec<f64> { (1..=top).chain((1..top).rev()).map(grid).collect() };
    let mut sweeps = Vec::new();
    for _ in 0..values.count("loops") {
        sweeps.push((Part::Major, "major loop".to_owned(), up_and_down(levels)));
    }
    for top in (1..levels).rev() {
        sweeps.push((Part::Reversal, format!("reversal at {:.3} A", grid(top)), up_and_down(top)));
    }
    let minor = [0.85, 0.3, 0.7, 0.3, 0.7, 0.4, 0.6, 0.4, 0.6, 0.3, 0.85];
    sweeps.push((Part::Minor, "minor loops".to_owned(), minor.map(|share| share * top_a).to_vec()));
    let mut rng = ChaCha8Rng::seed_from_u64(u64::from(values.count("order_seed")));
    // Alternately up and down to random currents.
    let (mut at, mut random) = (0.0, Vec::new());
    for turn in 0..values.count("random_turns") {
        at = if turn % 2 == 0 { rng.random_range(at..1.0) } else { rng.random_range(0.05 * at..at) };
        random.push(at * top_a);
    }
    sweeps.push((Part::Random, "random history".to_owned(), random));
    sweeps
}
