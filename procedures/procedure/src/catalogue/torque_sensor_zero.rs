//! Zero and drift of the torque sensor in each of its ranges, and the agreement of the ranges.
//!
//! A shaft line at rest always contains some torque from its wind-up. Therefore the joint moves out and back slowly
//! without load. The zero is half the sum of both directions, because drag has the sign of the motion and the zero
//! has not. Then the brake loads the line in both directions up to the smaller range, where both ranges measure the
//! same torque.

use super::legs::{ACCELERATION, Legs, sample_rate};
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::column_names::OTHER_RANGE;
use crate::findings::{Hold, Line, Mean, Unusable, curve, holds, quantity, scatter, verdict};
use crate::identification::{Axis, Figure, Form, Identification, Quantity, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use jointbench_instrument::{Kind, RunTable};

pub(super) struct TorqueSensorZero;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "torque_sensor_zero",
    title: "Zero of the torque sensor",
    summary: "Moves slowly in both directions without load. The mean of both directions is the zero of the sensor, \
              which drifts during warm-up. Compares the two ranges of the sensor under load.",
    kind: Kind::Friction,
    schema: &[
        Parameter::number("duration_s", "Duration", "s", 300.0, [10.0, 7200.0]),
        Parameter::number("speed_rad_s", "Speed (link)", "rad/s", 0.3, [0.05, 20.0]),
        Parameter::number("dwell_s", "Dwell time in each direction", "s", 2.0, [0.5, 60.0]),
        Parameter::number("steady_nm_per_min", "Steady when drift is below", "Nm/min", 0.002, [1e-5, 1.0]),
        Parameter::count("loads", "Loads for the comparison of the ranges", 4, [1, 20]),
        Parameter::number("top_torque_nm", "Maximum load, within the smaller range (link)", "Nm", 10.0, [0.1, 1000.0]),
        Parameter::number("agree_nm", "Ranges agree if they differ by less than (link)", "Nm", 0.12, [1e-4, 10.0]),
        ACCELERATION,
        sample_rate(100.0),
    ],
};

/// Steady-state share at the end of a hold, after the wind-up of the brake's rotor.
const SETTLED: f64 = 0.6;
/// Last share of the run, from which the zero and its drift are estimated.
const END: f64 = 1.0 / 3.0;

impl Procedure for TorqueSensorZero {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn is_modelled(&self) -> bool {
        false
    }

    fn can_resume(&self) -> Result<(), &'static str> {
        Err("the drift of the sensor is one history")
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        if !bench.has_torque_sensor {
            return Err(bench.missing("torque sensor", "connect it"));
        }
        let rate_hz = values.number("sample_rate_hz");
        let speed_rad_s = values.number("speed_rad_s") * bench.constants.gear_ratio;
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        let mut planned_s = 0.0;
        while planned_s < values.number("duration_s") {
            legs.leg(speed_rad_s, values.number("dwell_s"), 0.0);
            legs.leg(-speed_rad_s, values.number("dwell_s"), 0.0);
            legs.repeat += 1;
            planned_s = legs.steps.iter().map(crate::plan::Step::duration_s).sum();
        }
        if bench.has_two_ranges && bench.has_brake {
            compare(&mut legs, speed_rad_s, values, bench);
        }
        Ok(Plan { both_ranges: bench.has_two_ranges, ..legs.friction_plan(self, values, bench, rate_hz) })
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[("Nm", "zero drag zero_other disagreement"), ("Nm/min", "drift drift_other"), ("1", "gain_ratio")])
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(values, run))
    }
}

/// Rising loads, out and back at each of them.
fn compare(legs: &mut Legs, speed_rad_s: f64, values: &Values, bench: &BenchFacts) {
    let share = (values.number("top_torque_nm") / bench.constants.brake_rated_torque_nm).min(1.0);
    let loads = values.count("loads");
    let mut before_a = 0.0;
    for load in 1..=loads {
        let brake_a = share * bench.constants.brake_rated_current_a * f64::from(load) / f64::from(loads);
        legs.change(speed_rad_s, before_a, brake_a);
        legs.leg(speed_rad_s, values.number("dwell_s"), brake_a);
        legs.leg(-speed_rad_s, values.number("dwell_s"), brake_a);
        before_a = brake_a;
    }
    legs.unload(speed_rad_s, before_a, bench);
}

/// The zero of a range over time [min], and its value and drift in the last part.
struct Zero {
    points: Vec<(f64, f64)>,
    value: Mean,
    drift: Line,
    drag: Mean,
}

impl Zero {
    fn of(torque: &[f64], time_s: &[f64], held: &[Hold]) -> Result<Self, Unusable> {
        // A brake that was loaded keeps some remanence.
        let idle = &held[..held.iter().position(|hold| hold.brake != 0.0).unwrap_or(held.len())];
        let (mut points, mut drags) = (Vec::new(), Vec::new());
        for pair in idle.chunk_by(|a, b| a.repeat == b.repeat).filter(|pair| pair.len() == 2) {
            let [out, back] = [&pair[0], &pair[1]].map(|hold| hold.mean(torque, SETTLED));
            let at_min = 0.5 * (time_s[pair[0].rows.start] + time_s[pair[1].rows.end - 1]) / 60.0;
            points.push((at_min, 0.5 * (out + back)));
            drags.push(0.5 * (out - back));
        }
        let end = &points[points.len() - (points.len() as f64 * END).ceil() as usize..];
        let at_end: Vec<f64> = end.iter().map(|p| p.1).collect();
        let (Some(value), Some(drift), Some(drag)) = (Mean::of(&at_end), Line::through(end), Mean::of(&drags)) else {
            return Err(Unusable::InsufficientData("Too few strokes.", "Increase duration_s."));
        };
        Ok(Self { points, value, drift, drag })
    }

    fn is_steady(&self, bound_nm_per_min: f64) -> bool {
        self.drift.slope_ci95.map(f64::abs).into_iter().fold(0.0, f64::max) <= bound_nm_per_min
    }

    fn words(&self) -> String {
        format!("{:.1} mNm at the end of the run, drift {:.2} mNm/min", 1e3 * self.value.value, 1e3 * self.drift.slope)
    }
}

fn identify(values: &Values, run: &RunTable) -> Result<Identification, Unusable> {
    let used = run.column("link_torque_nm").unwrap_or_default();
    let time_s = run.column("time_s").unwrap_or_default();
    let held: Vec<_> = holds(run, 0.3).into_iter().filter(|hold| hold.velocity_rad_s != 0.0).collect();
    let zero = Zero::of(used, time_s, &held)?;
    let mut found = Identification {
        verdict: Verdict::Identified,
        summary: format!("Zero of the active range: {}.", zero.words()),
        quantities: vec![
            quantity(["zero", "τ₀", "Zero of the torque sensor", "Nm"], zero.value.value, Some(zero.value.ci95)),
            quantity(["drift", "dτ₀/dt", "Drift of the zero", "Nm/min"], zero.drift.slope, Some(zero.drift.slope_ci95)),
            quantity(["drag", "τ_d", "Drag torque of the drive line", "Nm"], zero.drag.value, Some(zero.drag.ci95)),
        ],
        figures: vec![over_time(&zero, "zero_over_time", "Zero of the torque sensor")],
        ..Identification::default()
    };
    let bound = values.number("steady_nm_per_min");
    let mut steady = zero.is_steady(bound);
    if let Some(other) = run.column(OTHER_RANGE) {
        let other_zero = Zero::of(other, time_s, &held)?;
        steady &= other_zero.is_steady(bound);
        found.summary += &format!(" Zero of the other range: {}.", other_zero.words());
        found.quantities.extend(of_other(&other_zero));
        found.figures.push(over_time(&other_zero, "other_zero_over_time", "Zero of the torque sensor, other range"));
        overlap(&mut found, &held, [used, other], values.number("agree_nm"))?;
    }
    if !steady {
        found.verdict = Verdict::Inconclusive;
        let advice = "Let the sensor warm up and repeat the run, or increase duration_s.";
        found.advice = Some([found.advice.as_deref().unwrap_or_default(), advice].join(" ").trim().to_owned());
    }
    Ok(found)
}

fn of_other(zero: &Zero) -> [Quantity; 2] {
    [
        quantity(["zero_other", "τ₀′", "Zero of the other range", "Nm"], zero.value.value, Some(zero.value.ci95)),
        quantity(
            ["drift_other", "dτ₀′/dt", "Drift of the zero of the other range", "Nm/min"],
            zero.drift.slope,
            Some(zero.drift.slope_ci95),
        ),
    ]
}

/// Readings of both ranges for the same torque, over all holds.
fn overlap(
    found: &mut Identification,
    held: &[Hold],
    [used, other]: [&[f64]; 2],
    agree_nm: f64,
) -> Result<(), Unusable> {
    let pairs: Vec<(f64, f64)> =
        held.iter().map(|hold| (hold.mean(used, SETTLED), hold.mean(other, SETTLED))).collect();
    let line =
        Line::through(&pairs).ok_or(Unusable::InsufficientData("All torques are equal.", "Increase top_torque_nm."))?;
    let apart: Vec<(f64, f64)> = pairs.iter().map(|(used, other)| (*used, other - used)).collect();
    let widest = apart.iter().map(|(_, apart)| apart.abs()).fold(0.0, f64::max);
    let (low, high) =
        pairs.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (p.0.min(low), p.0.max(high)));
    let agree = widest <= agree_nm;
    found.summary += &format!(
        " From {low:.1} to {high:.1} Nm the ranges differ by at most {:.1} mNm: they {}.",
        1e3 * widest,
        if agree { "agree" } else { "do not agree" }
    );
    if !agree {
        found.verdict = Verdict::Inconclusive;
        found.advice =
            Some("One of the ranges is wrong. Calibrate the sensor before its torque values are used.".into());
    }
    found.quantities.extend([
        quantity(["gain_ratio", "κ", "Gain ratio, other range / active range", "1"], line.slope, Some(line.slope_ci95)),
        quantity(["disagreement", "Δτ", "Maximum difference of the ranges", "Nm"], widest, None),
    ]);
    found.figures.push(Figure {
        name: "ranges_apart".into(),
        title: "Difference of the ranges".into(),
        form: Form::Cartesian,
        x: Axis::of("torque, active range", "Nm"),
        y: Axis::of("other range − active range", "Nm"),
        series: vec![
            scatter("constant speed and load", apart),
            curve("line", [low, high], 1, |torque| line.at(torque) - torque),
        ],
    });
    Ok(())
}

fn over_time(zero: &Zero, name: &str, title: &str) -> Figure {
    let last = zero.points.len() - 1;
    let first = zero.points.len() - (zero.points.len() as f64 * END).ceil() as usize;
    Figure {
        name: name.into(),
        title: title.into(),
        form: Form::Cartesian,
        x: Axis::of("time", "min"),
        y: Axis::of("torque", "Nm"),
        series: vec![
            scatter("mean of both directions", zero.points.iter().copied()),
            curve("drift", [zero.points[first].0, zero.points[last].0], 1, |t| zero.drift.at(t)),
        ],
    }
}
