//! The form of a hysteresis effect that explains most of the residual around reversals.

use crate::ModelSpec;
use crate::effect::Regime;
use crate::linear::basis::Basis;
use crate::preprocess::Problem;
use crate::regression::candidates::CandidateSet;
use crate::regression::linear_model::{LinearModel, Term, varpro};
use crate::regression::partial_regression::PartialRegression;

/// The residual of the model around reversals, and the hysteresis candidates.
pub struct Reversals<'p> {
    pub problem: &'p Problem,
    pub partial: PartialRegression,
    pub library: CandidateSet<'p>,
}

impl<'p> Reversals<'p> {
    /// `given` is the prediction of the rest of the model at the rows of `problem`.
    pub fn new(problem: &'p Problem, given: Vec<f64>, spec: &'p ModelSpec, wanted: impl Fn(&str) -> bool) -> Self {
        let mut terms = LinearModel::new(problem);
        terms.given = given;
        let mut library = CandidateSet::new(spec, problem, &[Regime::Hysteresis]);
        library.candidates.retain(|c| wanted(c.id()));
        Self { problem, partial: PartialRegression::new(Basis::default(), terms.response(), problem), library }
    }

    /// The effect in the form that explains most, and its partial R².
    pub fn best(&self) -> Option<(Term<'p>, f64)> {
        let shares = self.library.candidates.iter().map(|c| self.partial.orthogonalized(&c.columns).share);
        let (best, _) = shares.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let mut term = [self.library.candidates[best].term(self.problem)];
        let left = varpro(&mut term, &self.partial.basis, &self.partial.residual, self.problem);
        let [term] = term;
        Some((term, 1.0 - left / self.partial.sse))
    }
}

/// A hysteresis effect of the model in its best form. `None` without data to choose it by.
pub fn form_of<'p>(problem: &'p Problem, given: Vec<f64>, spec: &'p ModelSpec, id: &str) -> Option<Term<'p>> {
    Some(Reversals::new(problem, given, spec, |other| other == id).best()?.0)
}
