//! Expected separation of two models after one more run.
//!
//! T-optimality (Atkinson and Fedorov 1975): the best run is the one on which the alternative model, refitted to all
//! data, still cannot follow the other model.

use crate::linear::basis::dot;
use crate::linear::cholesky::Cholesky;
use crate::preprocess::Problem;
use crate::regression::linear_model::{LinearModel, Term};
use crate::regression::solution::Solution;
use crate::stats::summary::mean;

/// Noise of a measurement: a common part for all points of a block, and an independent part for each point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    pub block: f64,
    pub row: f64,
}

/// Fewer replicate pairs than this do not estimate noise.
const FEWEST_PAIRS: usize = 8;

impl Noise {
    /// Estimated from repeats if there are any, otherwise from the residual of the model.
    pub fn of(model: &LinearModel) -> Self {
        let problem = model.problem;
        let residual = model.linear().residual;
        let mut groups: Vec<((usize, usize), Vec<f64>)> = Vec::new();
        if problem.replicate_pairs.len() >= FEWEST_PAIRS {
            let mut pairs: Vec<_> = problem
                .replicate_pairs
                .iter()
                .map(|(a, b)| ((problem.block[*a], problem.block[*b]), (residual[*a] - residual[*b]) / 2f64.sqrt()))
                .collect();
            pairs.sort_by_key(|pair| pair.0);
            pairs.into_iter().for_each(|(key, value)| push(&mut groups, key, value));
        } else {
            for (e, b) in residual.iter().zip(&problem.block) {
                push(&mut groups, (*b, *b), *e);
            }
        }
        let (mut squares, mut free, mut between, mut shares) = (0.0, 0.0, 0.0, 0.0);
        for (_, values) in &groups {
            let middle = mean(values);
            squares += values.iter().map(|v| (v - middle).powi(2)).sum::<f64>();
            free += values.len() as f64 - 1.0;
            between += middle * middle;
            shares += 1.0 / values.len() as f64;
        }
        let g = groups.len().max(1) as f64;
        let row = squares / free.max(1.0);
        let block = (between / g - row * shares / g).max(0.0) + form_error(model);
        let size = (dot(&problem.target, &problem.target) / problem.rows().max(1) as f64).sqrt();
        Self { block: block.sqrt(), row: row.sqrt().max(1e-9 * size).max(f64::MIN_POSITIVE) }
    }

    /// The column in standard deviations, whitened for the common noise of the points of a block.
    pub fn whiten(&self, column: &[f64], problem: &Problem) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); problem.blocks];
        for (x, b) in column.iter().zip(&problem.block) {
            sums[*b].0 += x;
            sums[*b].1 += 1.0;
        }
        let (row, block) = (self.row * self.row, self.block * self.block);
        let lost: Vec<f64> = sums
            .iter()
            .map(|(sum, n): &(f64, f64)| (1.0 - (row / (row + n * block)).sqrt()) * sum / n.max(1.0))
            .collect();
        column.iter().zip(&problem.block).map(|(x, b)| (x - lost[*b]) / self.row).collect()
    }
}

/// Mean square of the form error of a model. In another run it has other values, and it is common to all points of a
/// stretch.
fn form_error(model: &LinearModel) -> f64 {
    let errs = Solution::of(model).map_or_else(Vec::new, |solution| solution.form_error(model));
    dot(&errs, &errs) / errs.len().max(1) as f64
}

fn push(groups: &mut Vec<((usize, usize), Vec<f64>)>, key: (usize, usize), value: f64) {
    match groups.last_mut() {
        Some((last, values)) if *last == key => values.push(value),
        _ => groups.push((key, vec![value])),
    }
}

/// A model on the measured run, with the information of that run about its parameters.
pub struct Side<'a> {
    model: &'a LinearModel<'a>,
    coefficients: Vec<Vec<f64>>,
    /// Whitened columns and derivatives at the measured run.
    columns: Vec<Vec<f64>>,
    /// Information about all parameters, including nonlinear ones.
    gram: Vec<f64>,
}

impl<'a> Side<'a> {
    pub fn new(model: &'a LinearModel<'a>, noise: &Noise) -> Self {
        let coefficients = model.linear().coefficients;
        let columns = tangent(model, &coefficients, noise);
        Self { model, gram: gram(&columns), columns, coefficients }
    }

    /// Whether the model has a nuisance effect that differs in each run.
    pub fn changes_by_run(&self) -> bool {
        self.model.terms.iter().any(|term| term.effect.traits().is_nuisance)
    }

    /// Expected distance of the two models in standard deviations after the run, as the mean over both models being
    /// the true one.
    pub fn separation(&self, alternative: &Side, run: &Problem, noise: &Noise) -> f64 {
        let difference: Vec<f64> =
            predict(self.model, run).iter().zip(predict(alternative.model, run)).map(|(a, b)| a - b).collect();
        let difference = noise.whiten(&difference, run);
        let (own, other) = (self.at(run, noise), alternative.at(run, noise));
        let one_way = |side: &Side, at: &RunColumns, wrong: &RunColumns| {
            // A term that only the other model has in the new run cannot be followed, unless this model has one as
            // well.
            let new = if at.new.is_empty() { wrong.new.as_slice() } else { &[] };
            std::iter::once(&difference).chain(new).map(|white| side.left_over(white, at)).sum::<f64>()
        };
        (0.5 * (one_way(self, &own, &other) + one_way(alternative, &other, &own))).max(0.0).sqrt()
    }

    /// Squared norm of the remainder of a whitened column at the new run, after the model is refitted within the
    /// information of the measured run.
    fn left_over(&self, white: &[f64], there: &RunColumns) -> f64 {
        let side: Vec<f64> = there.columns().map(|c| dot(c, white)).collect();
        let followed = Cholesky::new(&self.known_then(there), side.len(), 0.0).whiten(&side);
        dot(white, white) - dot(&followed, &followed)
    }

    /// Information about the coefficient of a further whitened column, from the measured run and with the new run:
    /// squared standard deviations of a coefficient of one.
    pub fn information(&self, now: &[f64], then: &[f64], there: &RunColumns) -> (f64, f64) {
        let alone: Vec<f64> = self.columns.iter().map(|c| dot(c, now)).collect();
        let begun = alone.iter().copied().chain(std::iter::repeat(0.0));
        let both: Vec<f64> = begun.zip(there.columns()).map(|(a, c)| a + dot(c, then)).collect();
        let known = |gram: &[f64], side: &[f64]| {
            let white = Cholesky::new(gram, side.len(), 0.0).whiten(side);
            dot(&white, &white)
        };
        let before = dot(now, now) - known(&self.gram, &alone);
        let after = dot(now, now) + dot(then, then) - known(&self.known_then(there), &both);
        (before.max(0.0), after.max(0.0))
    }

    /// Information about all parameters after both runs.
    fn known_then(&self, there: &RunColumns) -> Vec<f64> {
        let (before, all) = (self.columns.len(), there.columns().count());
        let mut both = gram(&there.columns().collect::<Vec<_>>());
        for a in 0..all {
            if a < before {
                (0..before).for_each(|b| both[a * all + b] += self.gram[a * before + b]);
            } else {
                both[a * all + a] += 1.0;
            }
        }
        both
    }

    /// The model at another run.
    pub fn at(&self, run: &Problem, noise: &Noise) -> RunColumns {
        let there = elsewhere(self.model, run);
        let (mut known, mut new) = (Vec::new(), Vec::new());
        for (term, coefficients) in there.terms.iter().zip(&self.coefficients) {
            if !term.effect.traits().is_nuisance {
                known.extend(term.columns.iter().map(|c| noise.whiten(c, run)));
                continue;
            }
            known.extend(coefficients.iter().map(|_| vec![0.0; run.rows()]));
            let size = (dot(coefficients, coefficients) / coefficients.len().max(1) as f64).sqrt();
            let sized = |column: &Vec<f64>| column.iter().map(|x| size * x).collect::<Vec<f64>>();
            new.extend(term.columns.iter().map(|c| noise.whiten(&sized(c), run)));
        }
        known.extend(there.slopes(&self.coefficients).into_iter().map(|(_, _, slope)| noise.whiten(&slope, run)));
        RunColumns { known, new }
    }
}

/// Whitened columns of a model at another run.
pub struct RunColumns {
    /// Columns of the parameters that the measured run has.
    known: Vec<Vec<f64>>,
    /// Columns of parameters that exist only in the new run, scaled by their expected size.
    new: Vec<Vec<f64>>,
}

impl RunColumns {
    fn columns(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.known.iter().chain(&self.new)
    }
}

/// Whitened columns of a model and its derivatives in the nonlinear parameters.
fn tangent(model: &LinearModel, coefficients: &[Vec<f64>], noise: &Noise) -> Vec<Vec<f64>> {
    let own = model.columns().into_iter().map(|c| noise.whiten(c, model.problem));
    let slopes = model.slopes(coefficients).into_iter().map(|(_, _, slope)| noise.whiten(&slope, model.problem));
    own.chain(slopes).collect()
}

fn gram<C: AsRef<[f64]>>(columns: &[C]) -> Vec<f64> {
    columns.iter().flat_map(|a| columns.iter().map(|b| dot(a.as_ref(), b.as_ref()))).collect()
}

/// The same terms at the points of another problem.
fn elsewhere<'a>(model: &LinearModel<'a>, problem: &'a Problem) -> LinearModel<'a> {
    let mut there = LinearModel::new(problem);
    there.terms = model.terms.iter().map(|t| Term::new(t.effect, t.form.clone(), t.shape.clone(), problem)).collect();
    there
}

/// Prediction of a model at another problem, without offset terms and nuisance effects that differ in each run.
pub fn predict(model: &LinearModel, problem: &Problem) -> Vec<f64> {
    let there = elsewhere(model, problem);
    let mut sum = vec![0.0; problem.rows()];
    let terms = there.terms.iter().zip(model.linear().coefficients);
    for (term, coefficients) in terms.filter(|(term, _)| !term.effect.traits().is_nuisance) {
        for (column, coefficient) in term.columns.iter().zip(coefficients) {
            sum.iter_mut().zip(column).for_each(|(s, c)| *s += coefficient * c);
        }
    }
    sum
}
