//! Difference between two brakes of the same type, at the shaft of the brake.
//!
//! The torque without current is subtracted on both sides, because it contains the drag of the transmission and of the
//! other brake. The model of the other brake predicts its torque after the same history of currents.

use super::super::brake_run::load_gear_ratio;
use crate::bench_facts::BenchFacts;
use crate::brake_model::{ComparedBrake, CurrentHistory};
use crate::findings::{Mean, bounded, percentage, quantity, t95};
use crate::identification::{Axis, Figure, Form, Mark, Quantity, Series};
use crate::plan::PlanFault;
use crate::thresholds::SAME_RANGE;
use jointbench_instrument::{Meta, RunTable};

/// Names of facts of the run: the other brake, and the run that measured it.
const OTHER: &str = "compared_brake";
const OTHER_RUN: &str = "compared_brake_of_run";
/// Half width of a 95 % interval of a normal deviate.
const NORMAL95: f64 = 1.96;
/// Stores the other brake with the run.
pub fn add_to(meta: &mut Meta, bench: &BenchFacts, top_a: f64) -> Result<(), PlanFault> {
    let other = bench.compared_brake.as_ref().ok_or_else(|| PlanFault::Contradiction {
        what: "the run of compare_run has no brake model".into(),
        cure: "enter a completed run of brake_hysteresis",
    })?;
    if top_a > SAME_RANGE * other.model.top_a() {
        let (known_a, cure) = (other.model.top_a(), "reduce top_current, or repeat that run with a larger one");
        let what = format!("the brake of compare_run is known up to {known_a:.3} A, and this run has {top_a:.3} A");
        return Err(PlanFault::Contradiction { what, cure });
    }
    let fact = serde_json::to_value(other).map_err(|fault| PlanFault::Contradiction {
        what: format!("the brake of compare_run cannot be stored: {fault}"),
        cure: "repeat that run",
    })?;
    meta.other.insert(OTHER.into(), fact);
    Ok(())
}

/// A current of the major loop, with the torques that it adds (at the brake).
#[derive(Clone, Copy)]
struct Point {
    current_a: f64,
    rises: bool,
    own_nm: f64,
    other_nm: f64,
}

impl Point {
    fn difference_nm(&self) -> f64 {
        self.own_nm - self.other_nm
    }
}

/// Both brakes on the major loop.
pub struct Comparison {
    /// Means over the loops.
    points: Vec<Point>,
    /// Half width of the interval of each difference, and of their mean. `None` for a single loop.
    reach_nm: Option<f64>,
    mean_reach_nm: Option<f64>,
    /// Rated torque of the brake of this run (Nm).
    rated_nm: f64,
    other_run: Option<i64>,
}

/// From the currents and torques of each major loop. `None` if the run names no other brake.
pub fn comparison(run: &RunTable, major: &[&[(f64, f64)]], rated_nm: f64) -> Option<Comparison> {
    let other: ComparedBrake = serde_json::from_value(run.meta().other.get(OTHER)?.clone()).ok()?;
    let ratio = load_gear_ratio(run);
    let loops: Vec<Vec<Point>> = major.iter().filter_map(|measured| points(measured, &other, ratio)).collect();
    let count = loops.first()?.len();
    let loops: Vec<Vec<Point>> = loops.into_iter().filter(|points| points.len() == count).collect();
    let n = loops.len() as f64;
    let mean = |value: &dyn Fn(&Point) -> f64, i: usize| loops.iter().map(|one| value(&one[i])).sum::<f64>() / n;
    let averaged = |(i, first): (usize, &Point)| Point {
        own_nm: mean(&|point| point.own_nm, i),
        other_nm: mean(&|point| point.other_nm, i),
        ..*first
    };
    let points: Vec<Point> = loops[0].iter().enumerate().map(averaged).collect();
    // The error of the other brake's model is common to all loops, and may be common to all currents.
    let other_reach_nm = NORMAL95 * other.error_nm / other.gear_ratio;
    let scatter = |one: &Vec<Point>| {
        one.iter().zip(&points).map(|(a, b)| (a.difference_nm() - b.difference_nm()).powi(2)).sum::<f64>()
    };
    let freedom = (n - 1.0) * count as f64;
    let reach_nm = (n > 1.0).then(|| {
        let deviation_nm = (loops.iter().map(scatter).sum::<f64>() / freedom).sqrt();
        (t95(freedom) * deviation_nm / n.sqrt()).hypot(other_reach_nm)
    });
    let of_loop = |one: &Vec<Point>| one.iter().map(Point::difference_nm).sum::<f64>() / count as f64;
    let means: Vec<f64> = loops.iter().map(of_loop).collect();
    let mean_reach_nm = Mean::of(&means).map(|mean| (mean.ci95[1] - mean.value).hypot(other_reach_nm));
    let other_run = run.meta().other.get(OTHER_RUN).and_then(serde_json::Value::as_i64);
    Some(Comparison { points, reach_nm, mean_reach_nm, rated_nm: rated_nm / ratio, other_run })
}

/// The points of one loop with current. Its end without current gives the drag.
fn points(measured: &[(f64, f64)], other: &ComparedBrake, ratio: f64) -> Option<Vec<Point>> {
    let (loaded, [(_, drag_nm)]) = measured.split_at(measured.len().checked_sub(1)?) else { return None };
    let (mut history, mut before_a) = (CurrentHistory::default(), 0.0);
    let mut points = Vec::new();
    for (current_a, torque_nm) in loaded.iter().filter(|(current_a, _)| *current_a > 0.0) {
        history.go(current_a.min(other.model.top_a()));
        points.push(Point {
            current_a: *current_a,
            rises: *current_a > before_a,
            own_nm: (torque_nm - drag_nm) / ratio,
            other_nm: (other.model.torque_nm(&history) - other.model.drag_nm()) / other.gear_ratio,
        });
        before_a = *current_a;
    }
    (!points.is_empty()).then_some(points)
}

impl Comparison {
    fn mean_nm(&self) -> f64 {
        self.points.iter().map(Point::difference_nm).sum::<f64>() / self.points.len() as f64
    }

    /// The point with the largest difference, as a fraction of the rated torque.
    fn largest(&self) -> f64 {
        let differences = self.points.iter().map(Point::difference_nm);
        differences.fold(0.0, |most: f64, nm| if nm.abs() > most.abs() { nm } else { most }) / self.rated_nm
    }

    fn top_nm(&self) -> f64 {
        let top = self.points.iter().max_by(|a, b| a.current_a.total_cmp(&b.current_a));
        top.map_or(0.0, Point::difference_nm)
    }

    pub fn quantities(&self) -> Vec<Quantity> {
        let around = |value: f64, reach: Option<f64>| reach.map(|reach| [value - reach, value + reach]);
        let (mean_nm, top_nm, largest) = (self.mean_nm(), self.top_nm(), self.largest());
        let share = self.reach_nm.map(|reach_nm| reach_nm / self.rated_nm);
        let words = |name, title| [name, "ΔT", title, "Nm"];
        vec![
            quantity(
                words("difference_mean", "Mean difference from the compared brake, at the brake"),
                mean_nm,
                around(mean_nm, self.mean_reach_nm),
            ),
            quantity(
                words("difference_top", "Difference from the compared brake at maximum current, at the brake"),
                top_nm,
                around(top_nm, self.reach_nm),
            ),
            percentage(
                ["difference_max", "ΔT/T", "Maximum difference from the compared brake, relative to rated torque"],
                largest,
                around(largest, share),
            ),
        ]
    }

    /// A sentence for the summary.
    pub fn words(&self) -> String {
        let of_run = self.other_run.map(|run| format!(" of run {run}")).unwrap_or_default();
        let mean_nm = self.mean_nm();
        let mean = match self.mean_reach_nm {
            Some(reach_nm) => bounded((mean_nm, [mean_nm - reach_nm, mean_nm + reach_nm]), "Nm"),
            None => format!("{mean_nm:.3} Nm"),
        };
        format!(
            " Difference from the brake{of_run}: mean {mean}, maximum {:.2} % of the rated torque (both without their torque \
             at zero current).",
            100.0 * self.largest().abs()
        )
    }

    pub fn figures(&self) -> Vec<Figure> {
        let branch = |rises: bool| self.points.iter().filter(move |point| point.rises == rises);
        let series = |label: &str, mark, rises: bool, y: fn(&Point) -> f64| {
            let (x, y) = branch(rises).map(|point| (point.current_a, y(point))).unzip();
            Series::new(label, mark, x, y)
        };
        let names = [("rising current", true), ("falling current", false)];
        let difference = |(label, rises): (&str, bool)| {
            let mut series = series(label, Mark::Line, rises, Point::difference_nm);
            let band = |reach_nm: f64| series.y.iter().map(|nm| [nm - reach_nm, nm + reach_nm]).collect();
            series.band = self.reach_nm.map(band).unwrap_or_default();
            series
        };
        let both = |(label, rises): (&str, bool)| {
            [
                series(&format!("this brake, {label}"), Mark::Points, rises, |point| point.own_nm),
                series(&format!("compared brake, {label}"), Mark::Line, rises, |point| point.other_nm),
            ]
        };
        let figure = |name: &str, title: &str, label: &str, series: Vec<Series>| Figure {
            name: name.into(),
            title: title.into(),
            form: Form::Cartesian,
            x: Axis::of("coil current", "A"),
            y: Axis::of(label, "Nm"),
            series,
        };
        vec![
            figure(
                "both_brakes",
                "Torque of both brakes without the torque at zero current",
                "torque at the brake",
                names.into_iter().flat_map(both).collect(),
            ),
            figure(
                "difference_over_current",
                "Difference between both brakes, with its 95 % interval",
                "this − compared brake",
                names.into_iter().map(difference).collect(),
            ),
        ]
    }
}
