//! A line of torsion over torque with an offset by direction, and whether the joint asks for more than a line.

use crate::findings::{Unusable, curve, holds, interval_of, keep_rows, parameter, quantity, scatter};
use crate::identification::{Axis, Figure, Form, Identification, Mark, Series, Verdict};
use jointbench_instrument::RunTable;
use jointbench_model::{Definition, Fit, ModelSpec, Options, OwnEffect, OwnParameter, fit};

/// The settled end of a hold: joint and brake wind up first.
const SETTLED: f64 = 0.5;
/// A curve is worth more than the line where it predicts what it has not seen this much better.
const BETTER: f64 = 0.85;

/// A joint that is soft until its teeth and belts carry: what it gives more than a spring ends at φ, and how sharply it
/// gets there is left open. φ is then what β₀ is for a line through high loads.
const SOFT: &str = "soft_start";
/// The end lies beyond the loads, and what is said of it hangs on the shape that leads there: one that bends late, and one
/// that bends early.
const SHAPES: [&str; 2] = [
    "torsion = phi * load / (t_h^p + abs(load)^p)^(1/p)",
    "torsion = phi * sign(load) * (1 - (1 + abs(load) / t_h)^(-p))",
];

/// No joint follows a shape to the last bit: those that leave less than this share of φ are equally good.
const ALIKE: f64 = 0.005;

/// `None`: there is no load to speak of.
fn softening(run: &RunTable, shape: &str) -> Option<OwnEffect> {
    let top = run.column("link_torque_nm")?.iter().fold(0.0f64, |m, t| m.max(t.abs()));
    let parameter = |name: &str, unit: &str, min: Option<f64>, max: Option<f64>| OwnParameter {
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
        sentence: "The joint gives more at low torque, until all its teeth carry.".into(),
    };
    OwnEffect::try_from(definition).ok()
}

/// Means of one hold: torque and torsion.
type Point = (f64, f64);

pub(super) fn identify(run: &RunTable) -> Result<Identification, Unusable> {
    let held: Vec<_> = holds(run, 0.4).into_iter().filter(|hold| hold.velocity_rad_s != 0.0).collect();
    let rows: Vec<_> = held.iter().map(|hold| hold.tail(SETTLED)).collect();
    if rows.len() < 6 {
        return Err(Unusable::TooLittle("the run holds too few loads: make it again to its end"));
    }
    let settled = keep_rows(run, &rows)?;
    let with = |more: &str, own: Vec<OwnEffect>| {
        let spec = ModelSpec::with_own(run.kind(), ["offset", "compliance", more], own)?;
        fit(&settled, &spec, &Options::default())
    };
    let line = with("directional_offset", Vec::new())?;
    let curve_of = |shape: &&str| with(SOFT, vec![softening(&settled, shape)?]).ok();
    let mut curves: Vec<Fit> = SHAPES.iter().filter_map(curve_of).collect();
    curves.retain(|curve| curve.validation_rms < BETTER * line.validation_rms);
    curves.sort_by(|a, b| a.validation_rms.total_cmp(&b.validation_rms));
    let end = curves.first().and_then(|best| Some(parameter(best, SOFT, "phi")?.value.abs()));
    let bound = curves.first().map_or(0.0, |best| best.validation_rms.max(ALIKE * end.unwrap_or(0.0)));
    curves.retain(|curve| curve.validation_rms <= bound);
    let is_curved = !curves.is_empty();
    let fits = if is_curved { curves } else { vec![line.clone()] };
    let best = &fits[0];

    let gear = run.meta().gear_ratio.unwrap_or(1.0);
    let points: Vec<Point> = rows
        .iter()
        .map(|rows| {
            let mean = |name: &str| {
                let column = &run.column(name).unwrap_or_default()[rows.clone()];
                column.iter().sum::<f64>() / column.len() as f64
            };
            (mean("link_torque_nm"), mean("motor_position_rad") / gear - mean("link_position_rad"))
        })
        .collect();
    let Some((inverse, inverse_ci95)) = of_all(&fits, "compliance", "inverse_k") else {
        return Err(Unusable::TooLittle("the loads do not decide the stiffness: raise top_load or load_levels"));
    };
    let bearing = run.meta().bearing_stiffness_nm_per_rad.map_or(0.0, f64::recip);
    if inverse_ci95[0] <= bearing {
        return Err(Unusable::TooLittle(
            "the bearing that was given is softer than bearing and joint together: give bearing_stiffness_nm_rad in Nm/rad, \
             or 0 where it is not known",
        ));
    }
    let stiffness = |inverse: f64| 1.0 / (inverse - bearing);
    let area = loop_area(run, &held, gear);
    let of_joint = match bearing > 0.0 {
        true => "Stiffness of the joint, bearing taken off",
        false => "Stiffness of joint and bearing",
    };
    let mut quantities = vec![
        quantity(["inverse_k", "k'⁻¹", "Compliance as measured", "rad/Nm"], inverse, Some(inverse_ci95)),
        quantity(
            ["k", "k", of_joint, "Nm/rad"],
            stiffness(inverse),
            Some([stiffness(inverse_ci95[1]), stiffness(inverse_ci95[0])]),
        ),
    ];
    let (effect, name, label) = match is_curved {
        true => (SOFT, "phi", "Offset of the line through high loads"),
        false => ("directional_offset", "beta_0", "Directional offset"),
    };
    if let Some(found) = of_all(&fits, effect, name) {
        let (value, ci95) = with_steps(found, run, gear);
        quantities.push(quantity(["beta_0", "β₀", label, "rad"], value, Some(ci95)));
    }
    if let Some(found) = parameter(best, "offset", "xi") {
        let (value, ci95) = with_steps(interval_of(found, 1.0), run, gear);
        quantities.push(quantity(["xi", "ξ", "Offset of the encoders", "rad"], value, Some(ci95)));
    }
    quantities.extend([
        quantity(["line_rms", "e_line", "What a line leaves on loads not seen", "rad"], line.validation_rms, None),
        quantity(["rms", "e", "What the chosen curve leaves on loads not seen", "rad"], best.validation_rms, None),
        quantity(["loop_area", "A", "Area of the loop at the highest load", "J"], area, None),
    ]);
    let shape = if is_curved {
        "softer at low torque: use the curve or a look-up table"
    } else {
        "linear: a line with an offset by direction is enough"
    };
    Ok(Identification {
        verdict: Verdict::Identified,
        summary: format!("The joint's stiffness is {:.1} Nm/rad; it is {shape}.", stiffness(inverse)),
        advice: (bearing == 0.0)
            .then(|| "Give bearing_stiffness_nm_rad where it is known: the figure contains the bearing.".into()),
        quantities,
        figures: vec![torsion_over_torque(&points, best), table(&points)],
    })
}

/// A figure that several fits have: the middle of what they find, and an interval that holds all of theirs. `None` where one
/// of them does not decide it.
fn of_all(fits: &[Fit], effect: &str, name: &str) -> Option<(f64, [f64; 2])> {
    let found: Vec<_> =
        fits.iter().map(|fit| Some(interval_of(parameter(fit, effect, name)?, 1.0))).collect::<Option<_>>()?;
    let least = |pick: fn(&(f64, [f64; 2])) -> f64| found.iter().map(pick).fold(f64::INFINITY, f64::min);
    let most = |pick: fn(&(f64, [f64; 2])) -> f64| found.iter().map(pick).fold(f64::NEG_INFINITY, f64::max);
    Some((0.5 * (least(|f| f.0) + most(|f| f.0)), [least(|f| f.1[0]), most(|f| f.1[1])]))
}

/// An offset is no surer than the encoders' steps, however many samples are averaged: a uniform error of one step each
/// (GUM, 4.3.7).
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

/// Work that one reversal and back takes at the highest load: the area between torsion and torque.
fn loop_area(run: &RunTable, held: &[crate::findings::Hold], gear: f64) -> f64 {
    let column = |name: &str| run.column(name).unwrap_or_default();
    let (motor, link, torque) = (column("motor_position_rad"), column("link_position_rad"), column("link_torque_nm"));
    let top = held.iter().map(|hold| hold.brake).fold(0.0, f64::max);
    let mut at_top = held.windows(2).filter(|pair| pair[0].brake == top && pair[1].brake == top);
    let Some(pair) = at_top.next() else { return 0.0 };
    // From the middle of one hold through the reversal to the middle of the next is half of the loop.
    let middle = |hold: &crate::findings::Hold| hold.rows.start + hold.rows.len() / 2;
    let rows = middle(&pair[0])..middle(&pair[1]);
    let twist = |i: usize| motor[i] / gear - link[i];
    let way: f64 = rows.clone().skip(1).map(|i| 0.5 * (torque[i] + torque[i - 1]) * (twist(i) - twist(i - 1))).sum();
    // What a straight spring between the same ends would take is given back; the rest is lost, in both halves.
    let (first, last) = (rows.start, rows.end - 1);
    let spring = 0.5 * (torque[first] + torque[last]) * (twist(last) - twist(first));
    2.0 * (way - spring).abs()
}

fn torsion_over_torque(points: &[Point], best: &Fit) -> Figure {
    let top = points.iter().map(|p| p.0.abs()).fold(0.0, f64::max);
    let value = |effect: &str, name: &str| parameter(best, effect, name).map_or(0.0, |p| p.value);
    let (xi, inverse, beta) =
        (value("offset", "xi"), value("compliance", "inverse_k"), value("directional_offset", "beta_0"));
    let mut series = vec![
        scatter("positive", points.iter().copied().filter(|p| p.0 > 0.0)),
        scatter("negative", points.iter().copied().filter(|p| p.0 <= 0.0)),
    ];
    if beta != 0.0 {
        series.push(curve("line, positive", [0.0, top], 1, |t| xi + inverse * t + beta));
        series.push(curve("line, negative", [-top, 0.0], 1, |t| xi + inverse * t - beta));
    }
    Figure {
        name: "torsion_over_torque".into(),
        title: "Torsion over torque".into(),
        form: Form::Cartesian,
        x: Axis::of("link torque", "Nm"),
        y: Axis::of("torsion", "rad"),
        series,
    }
}

/// The look-up table: mean torsion at each torque, both sides.
fn table(points: &[Point]) -> Figure {
    let top = points.iter().map(|p| p.0.abs()).fold(0.0, f64::max);
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let groups = sorted.chunk_by(|a, b| b.0 - a.0 < 0.02 * top);
    let mean = |group: &[Point]| {
        let n = group.len() as f64;
        (group.iter().map(|p| p.0).sum::<f64>() / n, group.iter().map(|p| p.1).sum::<f64>() / n)
    };
    let (x, y) = groups.map(mean).unzip();
    Figure {
        name: "look_up_table".into(),
        title: "Look-up table of the torsion".into(),
        form: Form::Cartesian,
        x: Axis::of("link torque", "Nm"),
        y: Axis::of("torsion", "rad"),
        series: vec![Series::new("table", Mark::Line, x, y)],
    }
}
