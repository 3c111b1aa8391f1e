//! Every effect that the model does not have, in every form, at every starting point of its shape.

use crate::ModelSpec;
use crate::effect::{Effect, Form, Stage};
use crate::linear::{Basis, Spd, dot};
use crate::prepare::Problem;
use crate::report::Invisible;
use crate::terms::{Term, columns};

/// An effect in one form at one shape.
pub struct Candidate<'e> {
    pub effect: &'e dyn Effect,
    pub form: Form<'e>,
    pub shape: Vec<f64>,
    pub columns: Vec<Vec<f64>>,
}

impl<'e> Candidate<'e> {
    pub fn id(&self) -> &'e str {
        self.effect.info().id
    }

    pub fn term(&self) -> Term<'e> {
        Term { effect: self.effect, form: self.form.clone(), shape: self.shape.clone(), columns: self.columns.clone() }
    }
}

pub struct Library<'e> {
    pub candidates: Vec<Candidate<'e>>,
    pub invisible: Vec<Invisible>,
}

/// What a candidate explains of a residual beyond a basis.
#[derive(Debug, Clone)]
pub struct Gain {
    /// Share of the residual's square.
    pub share: f64,
    /// The candidate's columns without what the basis explains.
    pub rest: Vec<Vec<f64>>,
}

impl<'e> Library<'e> {
    /// All candidates of the stages that this problem can judge.
    pub fn new(spec: &'e ModelSpec, problem: &Problem, stages: &[Stage]) -> Self {
        let mut library = Self { candidates: Vec::new(), invisible: Vec::new() };
        for effect in spec.known() {
            if effect.is_given() || !stages.contains(&effect.stage()) {
                continue;
            }
            if let Some(why) = effect.hidden(&problem.view) {
                library.invisible.push(Invisible { effect: effect.info().id.into(), why });
                continue;
            }
            for form in effect.forms(&problem.view) {
                for shape in &form.grid {
                    let columns = columns(effect, form.name, shape, problem);
                    library.candidates.push(Candidate { effect, form: form.clone(), shape: shape.clone(), columns });
                }
            }
        }
        library
    }
}

/// Where less than this share of a column is its own, the data cannot tell it from the model.
const OWN_SHARE: f64 = 1e-5;

/// The added-variable step: what the columns explain of a residual after the basis has had its part of both.
pub fn gain(columns: &[Vec<f64>], basis: &Basis, residual: &[f64], energy: f64) -> Gain {
    let mut rest: Vec<Vec<f64>> = columns.iter().map(|c| basis.rest(c)).collect();
    rest.retain_mut(|r| true_share(r, columns));
    let p = rest.len();
    let mut gram = vec![0.0; p * p];
    for a in 0..p {
        for b in 0..=a {
            gram[a * p + b] = dot(&rest[a], &rest[b]);
            gram[b * p + a] = gram[a * p + b];
        }
    }
    let side: Vec<f64> = rest.iter().map(|r| dot(r, residual)).collect();
    let explained: f64 = Spd::new(&gram, p, 0.0).whiten(&side).iter().map(|v| v * v).sum();
    Gain { share: if energy > 0.0 { explained / energy } else { 0.0 }, rest }
}

/// Factors of the columns beside a basis.
pub fn factors(columns: &[Vec<f64>], basis: &Basis, residual: &[f64]) -> Vec<f64> {
    let rest: Vec<Vec<f64>> = columns.iter().map(|c| basis.rest(c)).collect();
    let p = rest.len();
    let mut gram = vec![0.0; p * p];
    for a in 0..p {
        for b in 0..p {
            gram[a * p + b] = dot(&rest[a], &rest[b]);
        }
    }
    let side: Vec<f64> = rest.iter().map(|r| dot(r, residual)).collect();
    Spd::new(&gram, p, 0.0).solve(&side)
}

fn true_share(rest: &[f64], columns: &[Vec<f64>]) -> bool {
    let largest = columns.iter().map(|c| dot(c, c)).fold(0.0, f64::max);
    dot(rest, rest) > OWN_SHARE * largest
}
