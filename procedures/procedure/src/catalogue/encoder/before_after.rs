//! The error over the turn before and after the look-up table, as figures.

use super::series::histogram;
use super::spectrum::{ORDERS, PolePairs, Waves};
use super::sweeps::Sweep;
use super::table::{Table, means};
use crate::identification::{Axis, Figure, Form, Mark, Series, SeriesRole};
use std::f64::consts::TAU;

/// Points over the turn; each averages over many counts of the reference.
const PLACES: usize = 180;

/// Remaining error of a sweep at one of its readings.
pub type Left<'a> = &'a dyn Fn(&Sweep, usize) -> f64;

/// The error before or after the compensation: label, role and remaining error.
pub type Stage<'a> = (&'a str, SeriesRole, Left<'a>);

/// `sweeps` were not used for the table.
pub fn figures(sweeps: &[Sweep], table: &Table, poles: &PolePairs, stages: [Stage; 2]) -> Vec<Figure> {
    let slow_rad_s = sweeps.iter().map(|sweep| sweep.speed_rad_s.abs()).fold(f64::INFINITY, f64::min);
    let slow: Vec<&Sweep> = sweeps.iter().filter(|sweep| sweep.speed_rad_s.abs() < 1.1 * slow_rad_s).collect();
    let both_directions = |closed: bool| {
        let one = |(stage, role, left): Stage, direction: &str, sign: f64| {
            let sweeps = slow.iter().copied().filter(|sweep| sweep.speed_rad_s * sign > 0.0);
            around(&format!("{direction}, {stage}"), sweeps, left, closed).in_group(stage).with_role(role)
        };
        stages.map(|stage| [one(stage, "CCW", 1.0), one(stage, "CW", -1.0)]).concat()
    };
    let figure = |name: &str, title: String, x: Axis, y: Axis, series: Vec<Series>| Figure {
        name: name.into(),
        title,
        form: Form::Cartesian,
        x,
        y,
        series,
    };
    let error = || Axis::of("Test − reference", "rad");
    let title = |what: &str| format!("{what} at {slow_rad_s:.0} rad/s, CCW and CW");
    let mut over_angle = both_directions(false);
    over_angle.push(table.series("look-up table"));
    let all = |left: Left| -> Vec<f64> {
        sweeps.iter().flat_map(|sweep| (0..sweep.error_rad.len()).map(move |i| left(sweep, i))).collect()
    };
    let mut figures = vec![
        Figure {
            form: Form::Polar,
            ..figure("polar", title("Error over the turn"), Axis::of("Angle", "rad"), error(), both_directions(true))
        },
        figure("shape", title("Error over angle"), Axis::of("Angle", "rad"), error(), over_angle),
    ];
    figures.extend(harmonics(sweeps, poles, stages));
    figures.push(figure(
        "histogram",
        "Histogram of the error".into(),
        error(),
        Axis::of("Fraction", ""),
        stages.map(|(stage, role, left)| histogram(stage, &all(left), 60).with_role(role)).to_vec(),
    ));
    figures.push(figure(
        "spectrum",
        "Spectrum of the look-up table".into(),
        Axis::of("Periods per turn", ""),
        Axis::of("Amplitude", "rad"),
        vec![Series::new(
            "look-up table",
            Mark::Bars,
            (1..=ORDERS).map(f64::from).collect(),
            (1..=ORDERS).map(|order| table.harmonic(order)).collect(),
        )],
    ));
    figures
}

/// Means over the turn; a closed line if requested.
fn around<'s>(label: &str, sweeps: impl Iterator<Item = &'s Sweep>, left: Left, closed: bool) -> Series {
    let (mut x, mut y): (Vec<f64>, Vec<f64>) = means(sweeps, PLACES, left)
        .into_iter()
        .enumerate()
        .filter_map(|(i, mean)| Some(((i as f64 + 0.5) * TAU / PLACES as f64, mean?)))
        .unzip();
    if let (true, Some(first_x), Some(first_y)) = (closed, x.first().copied(), y.first().copied()) {
        x.push(first_x + TAU);
        y.push(first_y);
    }
    Series::new(label, Mark::Line, x, y)
}

/// The named harmonics, before and after, compared with the noise level.
fn harmonics(sweeps: &[Sweep], poles: &PolePairs, stages: [Stage; 2]) -> Option<Figure> {
    let named = poles.orders();
    let places: Vec<f64> = (0..named.len()).map(|i| i as f64).collect();
    let mut series = Vec::new();
    let mut noise_rad = 0.0;
    for (stage, role, left) in stages {
        let waves = Waves::of(sweeps, named.map(|(order, _)| order), left)?;
        let band = waves.ci95.to_vec();
        let bars = Series::new(stage, Mark::Bars, places.clone(), waves.amplitude_rad.to_vec());
        series.push(Series { band, ..bars.with_role(role) });
        noise_rad = waves.noise_rad;
    }
    series.push(Series::new("noise level (95 %)", Mark::Line, places, vec![noise_rad; named.len()]));
    Some(Figure {
        name: "harmonics".into(),
        title: "Harmonics of the error, 95 % intervals".into(),
        form: Form::Cartesian,
        x: Axis::names("Periods per turn", named.map(|(order, meaning)| format!("{order}× {meaning}"))),
        y: Axis::of("Amplitude", "rad"),
        series,
    })
}
