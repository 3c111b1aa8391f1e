//! Identification of the model from a run of sweeps, validated on the random history.

use super::super::brake_run::rated_nm;
use super::{Part, compare};
use crate::brake_model::{BrakeModel, CurrentHistory};
use crate::findings::{Hold, Mean, Unusable, holds, percentage, quantity, scatter};
use crate::identification::{Axis, Figure, Form, Identification, Mark, Series, Verdict};
use jointbench_instrument::RunTable;
use jointbench_model::stats::summary::mean;

/// Steady-state share at the end of a hold.
pub(in super::super) const SETTLED: f64 = 0.35;
/// Largest accepted torque error of a command through the model, as a share of the rated torque.
pub(in super::super) const BOUND: f64 = 0.01;

/// One measured sweep: currents and torques, from zero current to zero current.
struct Sweep {
    part: i64,
    points: Vec<(f64, f64)>,
}

const LITTLE: Unusable = Unusable::InsufficientData("The run ended before the last reversal curve.", "Repeat the run.");

pub(super) fn model(run: &RunTable) -> Result<BrakeModel, Unusable> {
    model_of(&sweeps(run))
}

/// The model and its RMS error on the validation histories (Nm).
pub(super) fn model_with_error(run: &RunTable) -> Option<(BrakeModel, f64)> {
    let sweeps = sweeps(run);
    let model = model_of(&sweeps).ok()?;
    let (_, error_nm) = Validation::of(&sweeps, &model)?.errors(1.0);
    Some((model, error_nm))
}

fn part(sweeps: &[Sweep], part: Part) -> impl Iterator<Item = &Sweep> {
    sweeps.iter().filter(move |sweep| sweep.part == part as i64)
}

fn model_of(sweeps: &[Sweep]) -> Result<BrakeModel, Unusable> {
    let major: Vec<&Sweep> = part(sweeps, Part::Major).collect();
    let first = major.first().ok_or(LITTLE)?;
    let top = first.points.iter().map(|p| p.0).fold(0.0, f64::max);
    let (grid, curves) = reversals(&major, part(sweeps, Part::Reversal), top).ok_or(LITTLE)?;
    BrakeModel::from_reversals(&grid, &curves).ok_or(LITTLE)
}

pub(super) fn identify(run: &RunTable) -> Result<Identification, Unusable> {
    let sweeps = sweeps(run);
    let model = model_of(&sweeps)?;
    let top = model.top_a();
    let rated = rated_nm(run).unwrap_or_else(|| model.torque_nm(&CurrentHistory::default().after(top)));
    let validation = Validation::of(&sweeps, &model).ok_or(LITTLE)?;
    let (worst, rms) = validation.errors(rated);
    let middle = 0.5 * top;
    let major = || part(&sweeps, Part::Major);
    let widths: Vec<f64> = major().filter_map(|sweep| width(sweep, middle)).collect();
    let full: Vec<f64> = major().filter_map(|s| s.points.iter().find(|p| p.0 == top).map(|p| p.1)).collect();
    let currents = model.currents() as f64;
    let mut quantities = vec![
        quantity(
            ["model_currents", "N", "Currents of the Preisach model (Everett form), including 0", ""],
            currents,
            None,
        ),
        quantity(["torque_top", "T_max", "Torque at maximum current", "Nm"], mean(&full), spread(&full)),
        quantity(["width", "ΔT", "Loop width at half of the maximum current", "Nm"], mean(&widths), spread(&widths)),
        quantity(["drag", "T₀", "Torque without current", "Nm"], model.torque_nm(&CurrentHistory::default()), None),
        percentage(["error_max", "e_max", "Maximum error, validation history, relative to rated torque"], worst, None),
        percentage(["error_rms", "e_rms", "RMS error, validation history, relative to rated torque"], rms, None),
        quantity(
            ["current_error", "e_I", "Maximum current error of the model inverse", "A"],
            validation.current_error_a,
            None,
        ),
        percentage(
            ["error_line", "e_line", "Maximum error of a linear model, relative to rated torque"],
            by_line(&sweeps, rated),
            None,
        ),
    ];
    let good = worst <= BOUND;
    let mut figures = [loops(&sweeps, &model), vec![judgement(&validation.torques_nm)]].concat();
    let mut words = String::new();
    if let Some(compared) = compare::comparison(run, &major().map(|sweep| &sweep.points[..]).collect::<Vec<_>>(), rated)
    {
        quantities.extend(compared.quantities());
        figures.extend(compared.figures());
        words = compared.words();
    }
    Ok(Identification {
        verdict: if good { Verdict::Identified } else { Verdict::Inconclusive },
        summary: format!(
            "Torque {:.2} Nm at {top:.3} A. Hysteresis at half of this current: {:.2} Nm (falling minus rising). Inverse of the \
             Preisach model: maximum torque error {:.2} % of rated on a random history.{words}",
            mean(&full),
            mean(&widths),
            100.0 * worst
        ),
        advice: (!good)
            .then(|| "Increase levels or dwell_s. The model error must be below 1 % of the rated torque.".into()),
        quantities,
        figures,
        ..Identification::default()
    })
}

/// The model and its inverse on the random history and the minor loops, from which it is not built.
struct Validation {
    /// Measured torque, and torque of the model.
    torques_nm: Vec<(f64, f64)>,
    /// Largest deviation of the inverse, which has to return the current of each measured torque.
    current_error_a: f64,
}

impl Validation {
    /// `None` without such sweeps.
    fn of(sweeps: &[Sweep], model: &BrakeModel) -> Option<Self> {
        let (mut torques_nm, mut current_error_a) = (Vec::new(), 0.0_f64);
        for sweep in part(sweeps, Part::Random).chain(part(sweeps, Part::Minor)) {
            let mut history = CurrentHistory::default();
            for (current, torque) in &sweep.points {
                if let Some(found) = model.current_a(&history, *torque) {
                    current_error_a = current_error_a.max((found - current).abs());
                }
                history.go(*current);
                torques_nm.push((*torque, model.torque_nm(&history)));
            }
        }
        (!torques_nm.is_empty()).then_some(Self { torques_nm, current_error_a })
    }

    /// Largest and RMS error of the torque, as shares of the rated torque.
    fn errors(&self, rated_nm: f64) -> (f64, f64) {
        let errors = || self.torques_nm.iter().map(|(torque, model)| (torque - model) / rated_nm);
        let worst = errors().map(f64::abs).fold(0.0, f64::max);
        let rms = (errors().map(|e| e * e).sum::<f64>() / self.torques_nm.len() as f64).sqrt();
        (worst, rms)
    }
}

/// The holds of every sweep, including the first one at zero current. A sweep that a pause interrupted is repeated as
/// a whole.
fn sweeps(run: &RunTable) -> Vec<Sweep> {
    let torque = run.column("brake_torque_nm").unwrap_or_default();
    let held: Vec<Hold> = holds(run, 0.3).into_iter().filter(|hold| hold.repeat > Part::Demagnetise as i64).collect();
    let sweep = |steps: &[Hold]| Sweep {
        part: steps[0].repeat,
        points: steps.iter().map(|hold| (hold.brake, hold.mean(torque, SETTLED))).collect(),
    };
    let is_whole = |steps: &&[Hold]| steps.len() > 1 && steps[steps.len() - 1].brake == 0.0;
    held.chunk_by(|a, b| a.segment == b.segment).filter(is_whole).map(sweep).collect()
}

/// The grid, and for each of its currents the torques of the falling branch, the lowest current first.
fn reversals<'s>(
    major: &[&Sweep],
    others: impl Iterator<Item = &'s Sweep>,
    top: f64,
) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let mut tops: Vec<(f64, Vec<&Sweep>)> = vec![(top, major.to_vec())];
    for sweep in others {
        tops.push((sweep.points.iter().map(|p| p.0).fold(0.0, f64::max), vec![sweep]));
    }
    tops.sort_by(|a, b| a.0.total_cmp(&b.0));
    let grid: Vec<f64> = std::iter::once(0.0).chain(tops.iter().map(|t| t.0)).collect();
    let mut curves = Vec::new();
    for (number, (top, sweeps)) in tops.iter().enumerate() {
        let mut sums = vec![0.0; number + 2];
        for sweep in sweeps {
            let turn = sweep.points.iter().position(|p| p.0 == *top)?;
            let down = &sweep.points[turn..];
            if down.len() != number + 2 {
                return None;
            }
            down.iter().rev().zip(&mut sums).for_each(|((_, torque), sum)| *sum += torque / sweeps.len() as f64);
        }
        curves.push(sums);
    }
    Some((grid, curves))
}

/// Torque of the falling branch minus that of the rising branch at a current, between the measured currents.
fn width(sweep: &Sweep, current_a: f64) -> Option<f64> {
    let at = |pair: &[(f64, f64)]| {
        let [(from_a, from_nm), (to_a, to_nm)] = [pair[0], pair[1]];
        let is_between = (from_a - current_a) * (to_a - current_a) <= 0.0 && from_a != to_a;
        is_between.then(|| from_nm + (current_a - from_a) / (to_a - from_a) * (to_nm - from_nm))
    };
    let mut crossings = sweep.points.windows(2).filter_map(at);
    Some(crossings.next_back()? - crossings.next()?)
}

/// `None` for a single value.
fn spread(values: &[f64]) -> Option<[f64; 2]> {
    Mean::of(values).map(|mean| mean.ci95)
}

/// Error of the torque per current from the data sheet.
fn by_line(sweeps: &[Sweep], rated: f64) -> f64 {
    let points = || sweeps.iter().flat_map(|sweep| &sweep.points);
    let (ii, it) = points().fold((0.0, 0.0), |(ii, it), (i, t)| (ii + i * i, it + i * t));
    points().map(|(i, t)| (t - it / ii * i).abs() / rated).fold(0.0, f64::max)
}

/// Points between two currents at which the model is drawn.
const PLACES: u32 = 12;

/// Major loop and reversal curves, from which the model is built, and the model's prediction for the minor loops and
/// the random history.
fn loops(sweeps: &[Sweep], model: &BrakeModel) -> Vec<Figure> {
    let measured = |label: &str, wanted: Part, mark: Mark| -> Vec<Series> {
        let series = |sweep: &Sweep| {
            let (x, y) = sweep.points.iter().copied().unzip();
            Series::new(label, mark, x, y)
        };
        part(sweeps, wanted).map(series).collect()
    };
    let modelled = |measured: &str, wanted: Part| -> Vec<Series> {
        part(sweeps, wanted).map(|sweep| course(measured, sweep, model)).collect()
    };
    let figure = |name: &str, title: &str, series: Vec<Vec<Series>>| Figure {
        name: name.into(),
        title: title.into(),
        form: Form::Cartesian,
        x: Axis::of("coil current", "A"),
        y: Axis::of("braking torque", "Nm"),
        series: series.concat(),
    };
    let mut figures = vec![figure(
        "torque_over_current",
        "Major loop and reversal curves",
        vec![
            measured("major loop", Part::Major, Mark::Points),
            measured("reversal curve", Part::Reversal, Mark::Line),
            modelled("major loop", Part::Major),
        ],
    )];
    for (name, title, label, wanted) in [
        ("minor_loops", "Minor loops (validation data)", "minor loops", Part::Minor),
        ("random_history", "Random history (validation data)", "random history", Part::Random),
    ] {
        figures.push(figure(name, title, vec![measured(label, wanted, Mark::Points), modelled(label, wanted)]));
    }
    figures
}

/// Prediction of the model along a measured sweep, including points between its currents.
fn course(measured: &str, sweep: &Sweep, model: &BrakeModel) -> Series {
    let mut history = CurrentHistory::default();
    let (mut x, mut y) = (vec![0.0], vec![model.torque_nm(&history)]);
    let mut from_a = 0.0;
    for (to_a, _) in &sweep.points {
        for place in 1..=PLACES {
            let at_a = from_a + (to_a - from_a) * (f64::from(place) / f64::from(PLACES));
            x.push(at_a);
            y.push(model.torque_nm(&history.after(at_a)));
        }
        history.go(*to_a);
        from_a = *to_a;
    }
    Series::new(&format!("model, {measured}"), Mark::Line, x, y).in_group(measured)
}

fn judgement(judged: &[(f64, f64)]) -> Figure {
    let number = |error: fn(&(f64, f64)) -> f64| judged.iter().enumerate().map(move |(i, p)| (i as f64, error(p)));
    Figure {
        name: "error_of_the_inverse".into(),
        title: "Error on validation histories".into(),
        form: Form::Cartesian,
        x: Axis::of("turn", ""),
        y: Axis::of("torque", "Nm"),
        series: vec![scatter("measured − model", number(|p| p.0 - p.1))],
    }
}
