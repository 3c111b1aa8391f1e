//! A model on one problem: effects with their forms, nonlinear parameters and columns at the rows.

pub use crate::regression::term::{Term, allows, columns, fixed_part};

use crate::effect::{Effect, ShapeSearch};
use crate::linear::basis::{Basis, dot};
use crate::linear::cholesky::Cholesky;
use crate::preprocess::Problem;
use crate::stats::summary::mean;
use crate::thresholds::NEGLIGIBLE_RMS;
use jointbench_instrument::Kind;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// A model on one problem.
#[derive(Clone)]
pub struct LinearModel<'p> {
    pub problem: &'p Problem,
    /// Sum of the offset terms, whose coefficient is one.
    pub given: Vec<f64>,
    /// Effects that are offset terms.
    pub offsets: Vec<&'p dyn Effect>,
    pub terms: Vec<Term<'p>>,
    /// Other forms of the effects, as nuisance columns: what the forms in the model cannot show.
    pub relatives: Arc<Vec<Term<'p>>>,
}

/// The solution of a model: coefficients of the columns of each term, and the residual.
pub struct Linear {
    pub coefficients: Vec<Vec<f64>>,
    pub residual: Vec<f64>,
    pub sse: f64,
}

impl<'p> LinearModel<'p> {
    pub fn new(problem: &'p Problem) -> Self {
        Self {
            problem,
            given: vec![0.0; problem.rows()],
            offsets: Vec::new(),
            terms: Vec::new(),
            relatives: Arc::default(),
        }
    }

    /// A term with the places of its coefficients among those of the effects.
    pub fn term(&self, id: &str) -> Option<(&Term<'p>, Range<usize>)> {
        let mut first = 0;
        self.terms.iter().find_map(|term| {
            let places = first..first + term.columns.len();
            first = places.end;
            (term.id() == id).then_some((term, places))
        })
    }

    pub fn contains(&self, id: &str) -> bool {
        self.terms.iter().any(|t| t.id() == id)
    }

    /// Whether it contains a delay of another effect.
    pub fn has_delay(&self) -> bool {
        self.terms.iter().any(|t| t.effect.traits().delay_of.is_some())
    }

    /// The model without one effect.
    pub fn without(&self, id: &str) -> Self {
        let mut less = self.clone();
        less.terms.retain(|t| t.id() != id);
        if less.relatives.iter().any(|r| r.id() == id) {
            less.relatives = Arc::new(less.relatives.iter().filter(|r| r.id() != id).cloned().collect());
        }
        less.refine();
        less
    }

    /// The model without an offset term.
    pub fn without_given(&self, effect: &dyn Effect) -> Self {
        let mut less = self.clone();
        for column in columns(effect, "linear", &[], self.problem) {
            less.given.iter_mut().zip(column).for_each(|(g, c)| *g -= c);
        }
        less.offsets.retain(|offset| offset.info().id != effect.info().id);
        less.refine();
        less
    }

    /// The model with the nonlinear parameters of one effect fixed.
    pub fn held(&self, id: &str) -> Self {
        let mut held = self.clone();
        for term in held.terms.iter_mut().filter(|t| t.id() == id) {
            for (shape, value) in Arc::make_mut(&mut term.form).shape.iter_mut().zip(&term.shape) {
                (shape.min, shape.max) = (*value, *value);
            }
        }
        held
    }

    /// Whether an error of this RMS is negligible relative to the measured signal. An encoder measurement consists of
    /// the errors themselves.
    pub fn is_negligible(&self, rms: f64, kind: Kind) -> bool {
        let response = self.response();
        let mean = mean(&response);
        let spread = (response.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / response.len() as f64).sqrt();
        kind != Kind::Encoder && rms < NEGLIGIBLE_RMS * spread
    }

    /// The response minus the offset terms and the fixed parts of the terms.
    pub fn response(&self) -> Vec<f64> {
        self.response_without(self.terms.iter())
    }

    /// The response minus the offset terms and the fixed parts of some terms.
    fn response_without<'t>(&self, terms: impl Iterator<Item = &'t Term<'p>>) -> Vec<f64>
    where
        'p: 't,
    {
        let mut response: Vec<f64> = self.problem.target.iter().zip(&self.given).map(|(y, g)| y - g).collect();
        terms.for_each(|term| subtract(&mut response, &term.fixed));
        response
    }

    pub fn columns(&self) -> Vec<&[f64]> {
        self.terms.iter().flat_map(|t| t.columns.iter().map(Vec::as_slice)).collect()
    }

    /// Derivatives of the model in every free nonlinear parameter, term by term.
    pub fn slopes(&self, coefficients: &[Vec<f64>]) -> Vec<(usize, usize, Vec<f64>)> {
        let mut out = Vec::new();
        for (i, (term, coefficients)) in self.terms.iter().zip(coefficients).enumerate() {
            out.extend(term.free().zip(slopes(term, coefficients, self.problem)).map(|(k, slope)| (i, k, slope)));
        }
        out
    }

    /// Refines all nonlinear parameters together. A coarse grid leaves a residual that a second, spurious effect
    /// would explain.
    pub fn refine(&mut self) {
        let moves = |t: &Term| t.form.shape.iter().any(|s| s.search != ShapeSearch::Whole);
        let free: Vec<usize> = (0..self.terms.len()).filter(|i| moves(&self.terms[*i])).collect();
        // With other forms as nuisance columns, the nonlinear parameters of the effect need no refinement.
        if free.is_empty() || self.problem.form_error.is_some() {
            return;
        }
        let fixed = (0..self.terms.len()).filter(|i| !free.contains(i)).flat_map(|i| &self.terms[i].columns);
        let basis = Basis::of(fixed);
        let still = (0..self.terms.len()).filter(|i| !free.contains(i)).map(|i| &self.terms[i]);
        let rest = basis.rest(&self.response_without(still));
        let mut moving: Vec<Term<'p>> = free.iter().map(|i| self.terms[*i].clone()).collect();
        varpro(&mut moving, &basis, &rest, self.problem);
        for (i, term) in free.into_iter().zip(moving) {
            self.terms[i] = term;
        }
    }
}

fn subtract(from: &mut [f64], part: &[f64]) {
    from.iter_mut().zip(part).for_each(|(y, part)| *y -= part);
}

/// ∂(Σ coefficient·column + fixed part) by a step of each free nonlinear parameter (see [`Shape::stepped`]), by central
/// differences. The reduction of columns to rows is linear, so that the sum is reduced only once.
///
/// [`Shape::stepped`]: crate::effect::Shape::stepped
pub(in crate::regression) fn slopes(term: &Term, coefficients: &[f64], problem: &Problem) -> Vec<Vec<f64>> {
    const STEP: f64 = 1e-4;
    let slope = |k: usize| {
        let at = |sign: f64| {
            let mut shape = term.shape.clone();
            shape[k] = term.form.shape[k].stepped(shape[k], sign * STEP);
            let fixed = term.effect.fixed_part(term.form.name, &shape, &problem.view);
            (term.effect.columns(term.form.name, &shape, &problem.view), fixed)
        };
        let ((mut up, fixed_up), (mut down, fixed_down)) = (at(1.0), at(-1.0));
        up.extend(fixed_up);
        down.extend(fixed_down);
        let mut slope = vec![0.0; up.first().map_or(0, Vec::len)];
        for ((u, d), f) in up.iter().zip(&down).zip(coefficients.iter().chain([&1.0])) {
            let scale = f / (2.0 * STEP);
            slope.iter_mut().zip(u.iter().zip(d)).for_each(|(s, (u, d))| *s += scale * (u - d));
        }
        slope
    };
    let free: Vec<usize> = term.free().collect();
    problem.reduce.apply_all(free.into_par_iter().map(slope).collect())
}

struct Reduced {
    columns: Vec<Vec<f64>>,
    coefficients: Vec<f64>,
    residual: Vec<f64>,
    sse: f64,
    spd: Cholesky,
}

fn reduce(terms: &[Term], basis: &Basis, rest: &[f64]) -> Reduced {
    let columns: Vec<Vec<f64>> = terms.iter().flat_map(|t| t.columns.iter().map(|c| basis.rest(c))).collect();
    let p = columns.len();
    let mut gram = vec![0.0; p * p];
    for a in 0..p {
        for b in 0..=a {
            gram[a * p + b] = dot(&columns[a], &columns[b]);
            gram[b * p + a] = gram[a * p + b];
        }
    }
    let spd = Cholesky::new(&gram, p, 1e-12);
    let mut residual = rest.to_vec();
    let fixed = terms.iter().filter(|term| !term.fixed.is_empty());
    fixed.for_each(|term| subtract(&mut residual, &basis.rest(&term.fixed)));
    let side: Vec<f64> = columns.iter().map(|c| dot(c, &residual)).collect();
    let coefficients = spd.solve(&side);
    for (c, f) in columns.iter().zip(&coefficients) {
        residual.iter_mut().zip(c).for_each(|(r, c)| *r -= f * c);
    }
    let sse = dot(&residual, &residual);
    Reduced { columns, coefficients, residual, sse, spd }
}

/// Refines changepoints: tries both neighbours at a decreasing distance.
fn narrow(terms: &mut [Term], basis: &Basis, rest: &[f64], problem: &Problem) -> Reduced {
    let mut best = reduce(terms, basis, rest);
    for i in 0..terms.len() {
        for k in 0..terms[i].shape.len() {
            let bounds = terms[i].form.shape[k];
            if bounds.search != ShapeSearch::Jump {
                continue;
            }
            let mut reach = (bounds.max - bounds.min) / terms[i].form.grid.len().max(2) as f64;
            for _ in 0..16 {
                for sign in [-1.0, 1.0] {
                    let mut trial = terms.to_vec();
                    trial[i].shape[k] = (trial[i].shape[k] + sign * reach).clamp(bounds.min, bounds.max);
                    trial[i].evaluate(problem);
                    let reduced = reduce(&trial, basis, rest);
                    if reduced.sse < best.sse {
                        terms.clone_from_slice(&trial);
                        best = reduced;
                        break;
                    }
                }
                reach *= 0.6;
            }
        }
    }
    best
}

/// Variable projection with Kaufman's Jacobian (Golub, Pereyra 2003; Kaufman 1975) in a Levenberg–Marquardt loop over
/// the nonlinear parameters. Parameters that cannot be negative are stepped in their logarithm. All stay within their
/// bounds.
pub fn varpro(terms: &mut [Term], basis: &Basis, rest: &[f64], problem: &Problem) -> f64 {
    let mut best = narrow(terms, basis, rest, problem);
    let index: Vec<(usize, usize)> =
        terms.iter().enumerate().flat_map(|(i, t)| t.free().map(move |k| (i, k))).collect();
    if index.is_empty() {
        return best.sse;
    }
    let mut damping = 1e-3;
    for _ in 0..12 {
        let mut jacobian = Vec::new();
        let mut next = best.coefficients.iter();
        for term in terms.iter() {
            let coefficients: Vec<f64> = next.by_ref().take(term.columns.len()).copied().collect();
            for slope in slopes(term, &coefficients, problem) {
                let mut slope = basis.rest(&slope);
                let side: Vec<f64> = best.columns.iter().map(|c| dot(c, &slope)).collect();
                for (c, f) in best.columns.iter().zip(best.spd.solve(&side)) {
                    slope.iter_mut().zip(c).for_each(|(s, c)| *s -= f * c);
                }
                jacobian.push(slope);
            }
        }
        let m = jacobian.len();
        let mut normal = vec![0.0; m * m];
        for a in 0..m {
            for b in 0..m {
                normal[a * m + b] = dot(&jacobian[a], &jacobian[b]);
            }
        }
        let side: Vec<f64> = jacobian.iter().map(|j| dot(j, &best.residual)).collect();
        let mut improved = false;
        for _ in 0..6 {
            let step = Cholesky::new(&normal, m, damping).solve(&side);
            let mut trial = terms.to_vec();
            for ((i, k), s) in index.iter().zip(&step) {
                let bounds = trial[*i].form.shape[*k];
                let value = bounds.stepped(trial[*i].shape[*k], s.clamp(-1.0, 1.0));
                trial[*i].shape[*k] = value.clamp(bounds.min, bounds.max);
            }
            for term in &mut trial {
                if !term.shape.is_empty() {
                    term.evaluate(problem);
                }
            }
            let reduced = reduce(&trial, basis, rest);
            if reduced.sse < best.sse {
                improved = best.sse - reduced.sse > 1e-5 * best.sse;
                terms.clone_from_slice(&trial);
                best = reduced;
                damping = (damping * 0.2).max(1e-9);
                break;
            }
            damping *= 8.0;
        }
        if !improved {
            break;
        }
    }
    best.sse
}
