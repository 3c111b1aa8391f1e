//! Speed dependence of the brake torque: constant currents, each at all speeds.

use super::brake_run;
use super::legs::{ACCELERATION, Legs, sample_rate, turn_s};
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::findings::{Line, Unusable, curve, holds, percentage, quantity, scatter, verdict};
use crate::identification::{Axis, Figure, Form, Identification, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use jointbench_instrument::{Kind, RunTable};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

pub(super) struct BrakeSpeedIndependence;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "brake_speed_independence",
    title: "Brake torque over speed",
    summary: "Measures the braking torque at constant currents over a range of speeds in both directions. Decides \
              whether the torque depends on speed.",
    kind: Kind::Brake,
    schema: &[
        Parameter::number("low_speed_rad_s", "Minimum speed (link)", "rad/s", 0.15, [0.11, 10.0]),
        Parameter::number("top_speed_rad_s", "Maximum speed (link)", "rad/s", 1.5, [0.2, 20.0]),
        Parameter::count("speeds", "Number of speeds (logarithmically spaced)", 6, [3, 30]),
        Parameter::count("currents", "Number of currents", 3, [1, 10]),
        Parameter::fraction("top_current", "Maximum current, relative to rated", 0.9, [0.05, 1.0]),
        Parameter::number("dwell_s", "Dwell time at each speed", "s", 1.5, [0.5, 60.0]),
        Parameter::fraction("bound", "Speed-independent if torque changes by less than", 0.02, [0.001, 0.5]),
        ACCELERATION,
        sample_rate(250.0),
        Parameter::count("order_seed", "Random seed (step order)", 1, [0, 1_000_000]),
    ],
};

/// Last share of a hold, after the wind-up of the brake's rotor.
const SETTLED: f64 = 0.6;

impl Procedure for BrakeSpeedIndependence {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        brake_run::check(bench)?;
        let gear = bench.constants.gear_ratio;
        let (low, top) = (values.number("low_speed_rad_s"), values.number("top_speed_rad_s"));
        if low >= top {
            return Err(PlanFault::Contradiction {
                what: format!("low_speed_rad_s = {low} must be below top_speed_rad_s = {top}"),
                cure: "swap the two values",
            });
        }
        let rate_hz = values.number("sample_rate_hz");
        let steps = f64::from(values.count("speeds") - 1);
        let speed = |i: u32| gear * low * (top / low).powf(f64::from(i) / steps);
        let speeds: Vec<f64> = (0..values.count("speeds")).map(speed).collect();
        let turning_rad_s = gear * (low * top).sqrt();
        let mut rng = ChaCha8Rng::seed_from_u64(u64::from(values.count("order_seed")));
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        let levels = values.count("currents");
        let mut before_a = 0.0;
        for level in 1..=levels {
            let current_a = values.number("top_current") * bench.constants.brake_rated_current_a * f64::from(level)
                / f64::from(levels);
            legs.change(turning_rad_s, before_a, current_a);
            legs.repeat = level;
            let mut order = speeds.clone();
            order.shuffle(&mut rng);
            for speed_rad_s in order {
                let dwell_s = turn_s(1.0 / 20.0, speed_rad_s, bench, values.number("dwell_s"));
                legs.leg(speed_rad_s, dwell_s, current_a);
                legs.leg(-speed_rad_s, dwell_s, current_a);
            }
            legs.repeat = 0;
            before_a = current_a;
        }
        legs.unload(gear * top, before_a, bench);
        Ok(legs.plan(self, values, brake_run::meta(bench, rate_hz), rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[("Nm", "torque_#"), ("Nm·s/rad", "slope_#"), ("%", "change_# change_max")])
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(values, run))
    }
}

fn identify(values: &Values, run: &RunTable) -> Result<Identification, Unusable> {
    let torque = run.column("brake_torque_nm").unwrap_or_default();
    let speed = run.column("velocity_rad_s").unwrap_or_default();
    let held = holds(run, 0.3);
    let (mut quantities, mut absolute, mut relative) = (Vec::new(), Vec::new(), Vec::new());
    let mut worst = 0.0_f64;
    for level in 1..=i64::from(values.count("currents")) {
        let own = held.iter().filter(|hold| hold.repeat == level && hold.velocity_rad_s != 0.0);
        let points: Vec<(f64, f64)> =
            own.map(|hold| (hold.mean(speed, SETTLED).abs(), hold.mean(torque, SETTLED))).collect();
        let Some(line) = Line::through(&points) else { continue };
        let current_a = held.iter().find(|hold| hold.repeat == level).map_or(0.0, |hold| hold.brake);
        let mean_nm = points.iter().map(|p| p.1).sum::<f64>() / points.len() as f64;
        let change = change(&points) / mean_nm;
        worst = worst.max(change);
        let current = format!("{current_a:.2} A");
        let at = format!(" at {current}");
        let named = |name: &str, symbol: &str, title: &str, unit: &str, value: f64, ci95| {
            quantity([&format!("{name}_{level}"), symbol, &format!("{title}{at}"), unit], value, ci95)
        };
        let title = format!("Relative change over speed{at}");
        quantities.extend([
            named("torque", "T", "Mean torque", "Nm", mean_nm, None),
            named("slope", "dT/dω", "Slope over speed", "Nm·s/rad", line.slope, Some(line.slope_ci95)),
            percentage([&format!("change_{level}"), "ΔT/T", &title], change, None),
        ]);
        let top = points.iter().map(|p| p.0).fold(0.0, f64::max);
        absolute.push(scatter(&current, points.iter().copied()));
        absolute.push(curve(&format!("line{at}"), [0.0, top], 1, |v| line.at(v)).in_group(&current));
        relative.push(scatter(&current, points.iter().map(|p| (p.0, 100.0 * p.1 / mean_nm))));
    }
    if absolute.is_empty() {
        return Err(Unusable::InsufficientData("No current was measured at three speeds.", "Repeat the run."));
    }
    let title = "Maximum relative change over speed, all currents";
    quantities.push(percentage(["change_max", "ΔT/T", title], worst, None));
    let bound = values.number("bound");
    let words = if worst <= bound { "is independent of speed" } else { "depends on speed" };
    let share = 100.0 * worst;
    Ok(Identification {
        verdict: Verdict::Identified,
        summary: format!("The torque {words}: maximum change {share:.2} % (limit {:.1} %).", 100.0 * bound),
        advice: (worst > bound).then(|| "Adjust the current at each speed when a constant load is required.".into()),
        quantities,
        figures: vec![
            over_speed("torque_over_speed", "Braking torque over speed", "braking torque", "Nm", absolute),
            over_speed(
                "torque_share_over_speed",
                "Braking torque relative to its mean",
                "braking torque, relative to its mean",
                "%",
                relative,
            ),
        ],
        ..Identification::default()
    })
}

/// Range of the means of both directions, because their difference does not depend on speed.
fn change(points: &[(f64, f64)]) -> f64 {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let groups = sorted.chunk_by(|a, b| b.0 / a.0 < 1.05);
    let means: Vec<f64> = groups.map(|group| group.iter().map(|p| p.1).sum::<f64>() / group.len() as f64).collect();
    means.iter().copied().fold(f64::NEG_INFINITY, f64::max) - means.iter().copied().fold(f64::INFINITY, f64::min)
}

fn over_speed(name: &str, title: &str, label: &str, unit: &str, series: Vec<crate::identification::Series>) -> Figure {
    Figure {
        name: name.into(),
        title: title.into(),
        form: Form::Cartesian,
        x: Axis::of("link velocity", "rad/s"),
        y: Axis::of(label, unit),
        series,
    }
}
