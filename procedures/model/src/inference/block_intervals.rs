//! Parameters of a model that is judged sample by sample, with 95 % intervals from a delete-block jackknife and from
//! other filter corners.

use crate::inference::harmonic_order::{self, Explained};
use crate::inference::parameter_state::{self, Intervals, Slot};
use crate::linear::added_columns::Added;
use crate::linear::cholesky::projections;
use crate::preprocess::Problem;
use crate::regression::linear_model::{LinearModel, Term, columns};
use crate::regression::solution::{Solution, weighted_like};
use crate::report::fit::{Parameter, ParameterState, TradeOff};
use crate::stats::summary::deviation;
use crate::stats::{jackknife, student};
use crate::thresholds::TRADE_OFF_CORRELATION;
use jointbench_instrument::Motion;
use rayon::prelude::*;
use std::sync::Arc;

/// Half width of a 95 % interval in standard deviations over the filter corners.
const OF_CORNERS: f64 = 2.05;

/// Parameters of the terms with 95 % intervals.
///
/// The half width combines two parts: the largest jackknife interval over blocks (Student's t) of all filter corners,
/// and the scatter of the estimate over the corners. At a physical bound it reaches from the bound to the half width
/// without the bound. The interval of a nonlinear parameter reaches to its neighbours
/// on the grid.
pub fn intervals(model: &LinearModel, motion: Motion) -> Option<Intervals> {
    let solution = Solution::of(model)?;
    let replicates = coefficients_without(&solution);
    let blocks = replicates.len() as f64;
    let t = student::half_width_95(blocks - 1.0);
    let others = model.problem.bandwidths.par_iter().filter_map(|problem| Estimates::of(&at_corner(model, problem)));
    let all: Vec<Estimates> = std::iter::once(Estimates::of(model)?).chain(others.collect::<Vec<_>>()).collect();
    let half_width = |k: usize| {
        let error = all.iter().map(|one| one.errors[k]).fold(0.0, f64::max);
        let estimates: Vec<f64> = all.iter().flat_map(|one| &one.coefficients).map(|one| one[k]).collect();
        (t * error).hypot(OF_CORNERS * deviation(&estimates))
    };
    let mut parameters = Vec::new();
    let mut names = Vec::new();
    for term in &model.terms {
        let info = term.effect.info();
        for name in &term.form.linear {
            let k = names.len();
            names.push(format!("{}.{name}", info.id));
            let (value, half) = (solution.coefficients[k], half_width(k));
            let slot = Slot {
                effect: info.id,
                name,
                unit: motion.label(info.unit(name)),
                value,
                possible: info.bounds(name),
                shape: None,
            };
            let is_at_bound = solution.bound.iter().any(|(at, _)| *at == k);
            let ci95 = [if is_at_bound { value } else { value - half }, value + half];
            let (mut state, mut note) = parameter_state::judge(&slot, ci95, half == 0.0 && value == 0.0);
            if is_at_bound {
                state = ParameterState::AtBound;
                note = Some(
                    "at its physical bound: the unconstrained estimate lies beyond it, but not significantly".into(),
                );
            }
            parameters.push(Parameter {
                effect: info.id.into(),
                name: (*name).into(),
                value,
                unit: slot.unit,
                ci95,
                state,
                note,
            });
        }
        parameters.extend(shapes(term, motion));
    }
    parameter_state::know_the_small(&mut parameters);
    harmonic_order::open(model, &mut parameters, |term, k| of_order(model, &solution, term, k));
    Some(Intervals { parameters, trade_offs: trade_offs(&replicates, &names) })
}

/// The validation errors and coefficients of a wave as functions of its order, in the place of the wave in a model. The
/// neighbouring orders among the nuisance terms are omitted: with them, no other order could explain the same.
fn of_order(model: &LinearModel, solution: &Solution, term: usize, k: usize) -> impl Fn(f64) -> Explained {
    let Term { effect, form, shape, columns: all, .. } = &model.terms[term];
    let each = all.len() / shape.len();
    let places = k * each..(k + 1) * each;
    let mut rest = model.clone();
    rest.terms[term].columns.drain(places.clone());
    let others = model.relatives.iter().filter(|relative| relative.id() != effect.info().id);
    rest.relatives = Arc::new(others.cloned().collect());
    let ridge = weighted_like(&rest, solution);
    move |order| {
        let wave = columns(*effect, form.name, &[order], model.problem);
        let wave: Vec<Vec<f32>> = wave.iter().map(|c| c.iter().map(|v| *v as f32).collect()).collect();
        let added = Added::new(&ridge, &wave);
        let gains = added.gains(0.0, |_| true);
        let losses = ridge.losses.iter().zip(gains).map(|(loss, gain)| loss - gain.validation_losses).collect();
        Explained { losses, coefficients: places.clone().zip(added.coefficients()).collect() }
    }
}

/// Coefficients of the effects by two attributions that explain the run equally well, and their standard errors.
struct Estimates {
    /// With all that other forms have in common with the effects, and with only what they have in common with their own
    /// effect.
    coefficients: [Vec<f64>; 2],
    /// The larger one of both attributions.
    errors: Vec<f64>,
}

impl Estimates {
    fn of(model: &LinearModel) -> Option<Self> {
        let solution = Solution::of(model)?;
        let moved = moved(model, &solution);
        let size = solution.coefficients.len();
        let only_own = |coefficients: &[f64], relatives: &[f64], k: usize| {
            coefficients[k] + moved.iter().zip(relatives).map(|(moved, c)| moved[k] * c).sum::<f64>()
        };
        let first = size + solution.error.len();
        let replicates: Vec<Vec<f64>> = solution.ridge.replicates().collect();
        let error_of = |k: usize| {
            let of_block = replicates.iter().map(|all| only_own(all, &all[first..], k));
            jackknife::variance_about_mean(of_block).sqrt()
        };
        let errors = solution.standard_errors().into_iter().enumerate().map(|(k, error)| error.max(error_of(k)));
        let others = (0..size).map(|k| only_own(&solution.coefficients, &solution.relatives, k)).collect();
        Some(Self { errors: errors.collect(), coefficients: [solution.coefficients.clone(), others] })
    }
}

/// What each effect gains for a unit of another form, if only its own forms count as its size.
fn moved(model: &LinearModel, solution: &Solution) -> Vec<Vec<f64>> {
    let columns = model.relatives.iter().flat_map(|relative| relative.columns.iter().map(move |c| (relative, c)));
    let of = |((relative, column), parts): ((&Term, &Vec<f64>), &Vec<f64>)| {
        let mut moved: Vec<f64> = parts.iter().map(|part| -part).collect();
        let mut first = 0;
        for term in &model.terms {
            if term.id() == relative.id() {
                let effects: Vec<&Vec<f64>> = term.columns.iter().collect();
                let projected = projections(std::slice::from_ref(column), &effects).remove(0);
                moved[first..].iter_mut().zip(projected).for_each(|(moved, part)| *moved += part);
            }
            first += term.columns.len();
        }
        moved
    };
    columns.zip(&solution.parts).map(of).collect()
}

/// Coefficients of the effects, refitted without each block in turn.
fn coefficients_without(solution: &Solution) -> Vec<Vec<f64>> {
    let size = solution.coefficients.len();
    solution.ridge.replicates().map(|all| all[..size].to_vec()).collect()
}

/// The same model at another filter corner.
fn at_corner<'p>(model: &LinearModel<'p>, problem: &'p Problem) -> LinearModel<'p> {
    let mut other = LinearModel::new(problem);
    for effect in &model.offsets {
        for column in columns(*effect, "linear", &[], problem) {
            other.given.iter_mut().zip(column).for_each(|(g, c)| *g += c);
        }
    }
    other.offsets.clone_from(&model.offsets);
    let term = |term: &Term<'p>| Term::new(term.effect, term.form.clone(), term.shape.clone(), problem);
    other.terms = model.terms.iter().map(term).collect();
    other.relatives = Arc::new(model.relatives.par_iter().map(term).collect());
    other
}

/// Nonlinear parameters of a term.
fn shapes(term: &Term, motion: Motion) -> Vec<Parameter> {
    let info = term.effect.info();
    let of = |(k, shape): (usize, &crate::effect::Shape)| {
        let value = term.shape[k];
        let mut tried: Vec<f64> = term.form.grid.iter().map(|point| point[k]).collect();
        tried.sort_by(f64::total_cmp);
        let below = tried.iter().rev().find(|v| **v < value).copied().unwrap_or(shape.min.min(value));
        let above = tried.iter().find(|v| **v > value).copied().unwrap_or(shape.max.max(value));
        let ci95 = if shape.is_smooth() { [below, above] } else { [value, value] };
        let unit = motion.label(info.unit(shape.name));
        let slot = Slot {
            effect: info.id,
            name: shape.name,
            unit,
            value,
            possible: (shape.min, shape.max),
            shape: Some(*shape),
        };
        let (state, note) =
            if shape.is_smooth() { parameter_state::judge(&slot, ci95, false) } else { (ParameterState::Ok, None) };
        Parameter { effect: info.id.into(), name: shape.name.into(), value, unit: slot.unit, ci95, state, note }
    };
    term.form.shape.iter().enumerate().map(of).collect()
}

fn trade_offs(replicates: &[Vec<f64>], names: &[String]) -> Vec<TradeOff> {
    let n = replicates.len() as f64;
    let mean = |k: usize| replicates.iter().map(|r| r[k]).sum::<f64>() / n;
    let means: Vec<f64> = (0..names.len()).map(mean).collect();
    let product = |a: usize, b: usize| replicates.iter().map(|r| (r[a] - means[a]) * (r[b] - means[b])).sum::<f64>();
    let mut out = Vec::new();
    for a in 0..names.len() {
        for b in 0..a {
            let correlation = product(a, b) / (product(a, a) * product(b, b)).sqrt();
            if correlation.abs() > TRADE_OFF_CORRELATION {
                out.push(TradeOff { first: names[b].clone(), second: names[a].clone(), correlation });
            }
        }
    }
    out
}
