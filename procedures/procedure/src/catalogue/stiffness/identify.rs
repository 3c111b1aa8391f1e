//! A line of torsion over torque with an offset for each direction, and a test for nonlinear stiffness.

use super::zones::zones;
use crate::findings::{Hold, Mean, Unusable, holds, interval_of, parameter, quantity, scatter, select_rows};
use crate::identification::{Axis, Figure, Form, Identification, Mark, Quantity, Series, SeriesRole, Verdict};
use crate::thresholds::{BETTER_CURVE, LOST_MOTION, SAME_CURVE};
use jointbench_instrument::RunTable;
use jointbench_model::stats::summary::mean;
use jointbench_model::{Definition, Fit, ModelSpec, Options, UserEffect, UserParameter, fit, residuals};
use std::ops::Range;

/// Steady-state share at the end of a hold, after the wind-up of joint and brake.
const SETTLED: f64 = 0.5;
/// A soft start: additional torsion at low load that saturates at φ, with an unknown sharpness. φ corresponds to β₀
/// of a line through high loads.
const SOFT: &str = "soft_start";
/// The saturation is beyond the loads, so that φ depends on the assumed shape: one that bends late, and one that
/// bends early.
const SHAPES: [&str; 2] = [
    "torsion = phi * load / (t_h^p + abs(load)^p)^(1/p)",
    "torsion = phi * sign(load) * (1 - (1 + abs(load) / t_h)^(-p))",
];

/// `None`: the load is too small.
fn softening(run: &RunTable, shape: &str) -> Option<UserEffect> {
    let top = run.column("link_torque_nm")?.iter().fold(0.0f64, |m, t| m.max(t.abs()));
    let parameter = |name: &str, unit: &str, min: Option<f64>, max: Option<f64>| UserParameter {
        name: name.into(),
        unit: unit.into(),
        min,
        max,
        start: None,
        whole: false,
    };
    let definition = Definition {
        id: SOFT.into(),
        kind: run.kind(),
        formula: shape.into(),
        parameters: vec![
            parameter("phi", "rad", None, None),
            parameter("t_h", "Nm", Some(0.01 * top), Some(top)),
            parameter("p", "1", Some(0.7), Some(6.0)),
        ],
        title: "Soft start".into(),
        sentence: "Stiffness is lower at low torque, until all teeth engage.".into(),
    };
    UserEffect::try_from(definition).ok()
}

/// Largest numbers of points in figures.
const LOOP_POINTS: usize = 800;
const CURVE_POINTS: usize = 100;

/// Means of one hold: torque and torsion.
type Point = (f64, f64);

/// The line, and the models of which the result is made.
struct Fits {
    line: Fit,
    /// Equally good models, the best first: curves if they are better than the line, otherwise the line.
    selected: Vec<Fit>,
    is_curved: bool,
}

impl Fits {
    /// `settled`: the rows at the ends of the holds.
    fn of(settled: &RunTable) -> Result<Self, Unusable> {
        let with = |more: &str, user_effects: Vec<UserEffect>| {
            let spec = ModelSpec::with_user_effects(settled.kind(), ["offset", "compliance", more], user_effects)?;
            fit(settled, &spec, &Options::default())
        };
        let line = with("directional_offset", Vec::new())?;
        let curve_of = |shape: &&str| with(SOFT, vec![softening(settled, shape)?]).ok();
        let mut curves: Vec<Fit> = SHAPES.iter().filter_map(curve_of).collect();
        curves.retain(|curve| curve.validation_rms < BETTER_CURVE * line.validation_rms);
        curves.sort_by(|a, b| a.validation_rms.total_cmp(&b.validation_rms));
        let end = curves.first().and_then(|best| Some(parameter(best, SOFT, "phi")?.value.abs()));
        let bound = curves.first().map_or(0.0, |best| best.validation_rms.max(SAME_CURVE * end.unwrap_or(0.0)));
        curves.retain(|curve| curve.validation_rms <= bound);
        let is_curved = !curves.is_empty();
        let selected = if is_curved { curves } else { vec![line.clone()] };
        Ok(Self { line, selected, is_curved })
    }

    fn best(&self) -> &Fit {
        &self.selected[0]
    }

    /// Slope k'⁻¹ of the line through high loads.
    fn compliance(&self) -> Option<(f64, [f64; 2])> {
        of_all(&self.selected, "compliance", "inverse_k")
    }

    fn offsets(&self, run: &RunTable, gear: f64) -> Vec<Quantity> {
        let mut found = Vec::new();
        let (effect, name, label) = match self.is_curved {
            true => (SOFT, "phi", "Offset of the line at high loads"),
            false => ("directional_offset", "beta_0", "Directional offset"),
        };
        if let Some(offset) = of_all(&self.selected, effect, name) {
            let (value, ci95) = with_steps(offset, run, gear);
            found.push(quantity(["beta_0", "β₀", label, "rad"], value, Some(ci95)));
        }
        if let Some(offset) = parameter(self.best(), "offset", "xi") {
            let (value, ci95) = with_steps(interval_of(offset, 1.0), run, gear);
            found.push(quantity(["xi", "ξ", "Offset of the encoders", "rad"], value, Some(ci95)));
        }
        found
    }

    fn errors(&self) -> [Quantity; 2] {
        let of_line = ["line_rms", "e_line", "Validation error of the straight line (RMS)", "rad"];
        let of_best = ["rms", "e", "Validation error of the selected curve (RMS)", "rad"];
        [quantity(of_line, self.line.validation_rms, None), quantity(of_best, self.best().validation_rms, None)]
    }
}

/// Stiffness of the joint from the measured compliance and the compliance of the bearing in series with it.
fn stiffness((inverse, ci95): (f64, [f64; 2]), bearing: f64) -> [Quantity; 2] {
    let of_joint = match bearing > 0.0 {
        true => "Stiffness of the joint, without bearing",
        false => "Stiffness of joint and bearing",
    };
    let stiffness = |inverse: f64| 1.0 / (inverse - bearing);
    [
        quantity(["inverse_k", "k'⁻¹", "Measured compliance", "rad/Nm"], inverse, Some(ci95)),
        quantity(["k", "k", of_joint, "Nm/rad"], stiffness(inverse), Some([stiffness(ci95[1]), stiffness(ci95[0])])),
    ]
}

/// Mean torque and torsion of some rows.
fn point(run: &RunTable, rows: &Range<usize>, gear: f64) -> Point {
    let mean = |name: &str| {
        let column = &run.column(name).unwrap_or_default()[rows.clone()];
        mean(column)
    };
    (mean("link_torque_nm"), mean("motor_position_rad") / gear - mean("link_position_rad"))
}

pub(super) fn identify(run: &RunTable) -> Result<Identification, Unusable> {
    let held: Vec<_> = holds(run, 0.4).into_iter().filter(|hold| hold.velocity_rad_s != 0.0).collect();
    let rows: Vec<_> = held.iter().map(|hold| hold.tail(SETTLED)).collect();
    if rows.len() < 6 {
        return Err(Unusable::InsufficientData("The run contains too few loads.", "Repeat the run."));
    }
    let settled = select_rows(run, &rows)?;
    let fits = Fits::of(&settled)?;
    let gear = run.meta().gear_ratio.unwrap_or(1.0);
    let points: Vec<Point> = rows.iter().map(|rows| point(run, rows, gear)).collect();
    let Some(compliance) = fits.compliance() else {
        return Err(Unusable::InsufficientData(
            "The loads do not determine the stiffness.",
            "Increase top_load or load_levels.",
        ));
    };
    let bearing = run.meta().bearing_stiffness_nm_per_rad.map_or(0.0, f64::recip);
    if compliance.1[0] <= bearing {
        return Err(Unusable::InsufficientData(
            "bearing_stiffness_nm_rad is below the measured stiffness of bearing and joint.",
            "Enter it in Nm/rad, or 0 if unknown.",
        ));
    }
    let reversals = Reversal::all(run, &held, gear);
    let [measured, joint] = stiffness(compliance, bearing);
    let shape = if fits.is_curved {
        "Stiffness decreases at low torque. Use the curve or a look-up table"
    } else {
        "Linear with a directional offset"
    };
    let summary = format!("Stiffness of the joint {:.1} Nm/rad. {shape}.", joint.value);
    let mut quantities = vec![measured, joint];
    quantities.extend(fits.offsets(run, gear));
    quantities.extend(zones(&points, bearing));
    quantities.extend(loops(&reversals));
    quantities.extend(fits.errors());
    let whole = torsion_over_torque(&points, model(&settled, fits.best())?, reversals.first());
    let beyond = beyond_the_slope(&whole, compliance.0);
    Ok(Identification {
        verdict: Verdict::Identified,
        summary,
        advice: advice(bearing, reversals.len()),
        quantities,
        figures: vec![whole, beyond],
        ..Identification::default()
    })
}

fn advice(bearing: f64, loops: usize) -> Option<String> {
    let of_bearing =
        (bearing == 0.0).then_some("The value includes the bearing. Enter bearing_stiffness_nm_rad to separate it.");
    let of_loops = (loops == 1).then_some("The loop was measured once and has no interval. Increase repeats for one.");
    let all: Vec<&str> = [of_bearing, of_loops].into_iter().flatten().collect();
    (!all.is_empty()).then(|| all.join(" "))
}

/// The figures of the loops at the highest load: means over the repeats, with intervals from their scatter.
fn loops(reversals: &[Reversal]) -> Vec<Quantity> {
    let width = ["hysteresis_width", "Δφ₀", "Hysteresis: torsion between both branches without torque", "rad"];
    let lost = ["lost_motion", "φ_L", "Lost motion: torsion from −3 % to +3 % of the highest torque", "rad"];
    let area = ["loop_area", "A", "Loop area at maximum load", "J"];
    let of = |words, figure: &dyn Fn(&Reversal) -> Option<f64>| {
        let values: Vec<f64> = reversals.iter().filter_map(figure).collect();
        let value = mean(&values);
        (!values.is_empty()).then(|| quantity(words, value, Mean::of(&values).map(|mean| mean.ci95)))
    };
    let found = [of(width, &Reversal::width), of(lost, &Reversal::lost_motion), of(area, &|one| Some(one.area_j()))];
    found.into_iter().flatten().collect()
}

/// A parameter of several fits: the mean of the estimates, and an interval that contains all of theirs. `None` if one
/// fit does not identify it.
fn of_all(fits: &[Fit], effect: &str, name: &str) -> Option<(f64, [f64; 2])> {
    let found: Vec<_> =
        fits.iter().map(|fit| Some(interval_of(parameter(fit, effect, name)?, 1.0))).collect::<Option<_>>()?;
    let least = |pick: fn(&(f64, [f64; 2])) -> f64| found.iter().map(pick).fold(f64::INFINITY, f64::min);
    let most = |pick: fn(&(f64, [f64; 2])) -> f64| found.iter().map(pick).fold(f64::NEG_INFINITY, f64::max);
    Some((0.5 * (least(|f| f.0) + most(|f| f.0)), [least(|f| f.1[0]), most(|f| f.1[1])]))
}

/// An offset is not more accurate than the encoder counts, independent of the number of samples: a uniform error of
/// one count each (GUM, 4.3.7).
fn with_steps((value, ci95): (f64, [f64; 2]), run: &RunTable, gear: f64) -> (f64, [f64; 2]) {
    let step = |name: &str| {
        let channel = run.trace().channels().iter().find(|channel| channel.name == name);
        channel.and_then(|channel| channel.resolution).unwrap_or(0.0)
    };
    let steps =
        1.96 * (step("link_position_rad") / 12f64.sqrt()).hypot(step("motor_position_rad") / gear / 12f64.sqrt());
    let reach = (0.5 * (ci95[1] - ci95[0])).hypot(steps);
    (value, [value - reach, value + reach])
}

/// A reversal in both directions: from the middle of a hold at the highest load to the middle of the next one, and
/// back to the one after it.
struct Reversal {
    course: Vec<Point>,
    /// Rows of the first half.
    there: usize,
}

impl Reversal {
    /// The loop of each repeat.
    fn all(run: &RunTable, held: &[Hold], gear: f64) -> Vec<Self> {
        let top = held.iter().map(|hold| hold.brake).fold(0.0, f64::max);
        let of_repeat = |repeat: &[Hold]| Self::of(run, repeat, top, gear);
        held.chunk_by(|a, b| a.repeat == b.repeat).filter_map(of_repeat).collect()
    }

    fn of(run: &RunTable, held: &[Hold], top: f64, gear: f64) -> Option<Self> {
        let column = |name: &str| run.column(name).unwrap_or_default();
        let (motor, link, torque) =
            (column("motor_position_rad"), column("link_position_rad"), column("link_torque_nm"));
        let first = held.windows(2).position(|pair| pair[0].brake == top && pair[1].brake == top)?;
        let middle = |hold: &Hold| hold.rows.start + hold.rows.len() / 2;
        let (begin, turn) = (middle(&held[first]), middle(&held[first + 1]));
        let back = held.get(first + 2).filter(|hold| hold.brake == top);
        let end = back.map_or(turn, middle);
        let course = (begin..end).map(|i| (torque[i], motor[i] / gear - link[i])).collect();
        Some(Self { course, there: turn - begin })
    }

    /// Torsions of both branches at a torque, if the run returns to the load at which the loop began.
    fn torsions(&self, torque: f64) -> Option<[f64; 2]> {
        let (there, back) = self.course.split_at(self.there);
        Some([crossing(there, torque)?, crossing(back, torque)?])
    }

    fn width(&self) -> Option<f64> {
        let [down, up] = self.torsions(0.0)?;
        Some((down - up).abs())
    }

    fn lost_motion(&self) -> Option<f64> {
        let top = self.course.iter().map(|p| p.0.abs()).fold(0.0, f64::max);
        let (low, high) = (self.torsions(-LOST_MOTION * top)?, self.torsions(LOST_MOTION * top)?);
        Some(((high[0] + high[1] - low[0] - low[1]) / 2.0).abs())
    }

    /// Hysteresis loss: the area between torsion and torque in both halves, without the elastic energy of a linear
    /// spring between the ends.
    fn area_j(&self) -> f64 {
        let there = &self.course[..self.there];
        let way: f64 = there.windows(2).map(|w| 0.5 * (w[1].0 + w[0].0) * (w[1].1 - w[0].1)).sum();
        let (first, last) = (there[0], there[there.len() - 1]);
        2.0 * (way - 0.5 * (first.0 + last.0) * (last.1 - first.1)).abs()
    }

    fn series(&self) -> Series {
        let every = self.course.len().div_ceil(LOOP_POINTS);
        let (x, y) = self.course.iter().copied().step_by(every).unzip();
        Series::new("loop at maximum load", Mark::Line, x, y).with_role(SeriesRole::Loop)
    }
}

/// Mean torsion where a branch crosses a torque, because noise causes several crossings. `None` without a crossing.
fn crossing(branch: &[Point], torque: f64) -> Option<f64> {
    let crossings: Vec<f64> = branch
        .windows(2)
        .filter(|pair| (pair[0].0 - torque) * (pair[1].0 - torque) <= 0.0 && pair[0].0 != pair[1].0)
        .map(|pair| pair[0].1 + (torque - pair[0].0) / (pair[1].0 - pair[0].0) * (pair[1].1 - pair[0].1))
        .collect();
    (!crossings.is_empty()).then(|| mean(&crossings))
}

/// The selected model over the held loads, separately for each direction.
fn model(settled: &RunTable, best: &Fit) -> Result<[Series; 2], Unusable> {
    let set = residuals(settled, best, &Options::default())?;
    let load = set.axes.iter().find(|axis| axis.name == "link_torque_nm");
    let load = load.map(|axis| &axis.values[..]).unwrap_or_default();
    let mut points: Vec<Point> = load.iter().copied().zip(set.predicted).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (positive, negative) = points.into_iter().partition(|p| p.0 > 0.0);
    let series = |side: &str, points: Vec<Point>| {
        let every = points.len().div_ceil(CURVE_POINTS).max(1);
        let (x, y) = points.into_iter().step_by(every).unzip();
        Series::new(&format!("model, {side}"), Mark::Line, x, y).in_group(side)
    };
    Ok([series("positive", positive), series("negative", negative)])
}

fn torsion_over_torque(points: &[Point], model: [Series; 2], reversal: Option<&Reversal>) -> Figure {
    let mut series: Vec<Series> = reversal.map(Reversal::series).into_iter().collect();
    let side = |is_positive: bool| points.iter().copied().filter(move |p| (p.0 > 0.0) == is_positive);
    series.extend([scatter("positive", side(true)), scatter("negative", side(false))]);
    series.extend(model);
    series.push(table(points));
    Figure {
        name: "torsion_over_torque".into(),
        title: "Torsion over torque".into(),
        form: Form::Cartesian,
        x: Axis::of("link torque", "Nm"),
        y: Axis::of("torsion", "rad"),
        series,
    }
}

/// The look-up table: mean torsion at each torque, both signs.
fn table(points: &[Point]) -> Series {
    let top = points.iter().map(|p| p.0.abs()).fold(0.0, f64::max);
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let groups = sorted.chunk_by(|a, b| b.0 - a.0 < 0.02 * top);
    let mean = |group: &[Point]| {
        let n = group.len() as f64;
        (group.iter().map(|p| p.0).sum::<f64>() / n, group.iter().map(|p| p.1).sum::<f64>() / n)
    };
    let (x, y) = groups.map(mean).unzip();
    Series::new("look-up table", Mark::Line, x, y)
}

/// Without the slope of the line through high loads, because a loop and a soft start are not visible otherwise.
fn beyond_the_slope(whole: &Figure, inverse: f64) -> Figure {
    let level = |one: &Series| Series {
        y: one.x.iter().zip(&one.y).map(|(torque, torsion)| torsion - inverse * torque).collect(),
        ..one.clone()
    };
    Figure {
        name: "beyond_the_slope".into(),
        title: "Residual torsion (linear part removed)".into(),
        y: Axis::of("torsion − k'⁻¹·torque", "rad"),
        series: whole.series.iter().map(level).collect(),
        ..whole.clone()
    }
}
