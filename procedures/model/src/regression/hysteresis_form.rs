//! The form of an effect with a memory that explains most of what the rest of a model leaves around reversals.

use crate::ModelSpec;
use crate::effect::Stage;
use crate::linear::basis::Basis;
use crate::preprocess::Problem;
use crate::regression::candidates::Library;
use crate::regression::linear_model::{Term, Terms, polish};
use crate::regression::partial_regression::Ground;

/// What the rest of the model leaves around reversals, and the effects with a memory that may explain it.
pub struct Reversals<'p> {
    pub problem: &'p Problem,
    pub ground: Ground,
    pub library: Library<'p>,
}

impl<'p> Reversals<'p> {
    /// `given` is what the rest of the model predicts at the rows of `problem`.
    pub fn new(problem: &'p Problem, given: Vec<f64>, spec: &'p ModelSpec, wanted: impl Fn(&str) -> bool) -> Self {
        let mut terms = Terms::new(problem);
        terms.given = given;
        let mut library = Library::new(spec, problem, &[Stage::Memory]);
        library.candidates.retain(|c| wanted(c.id()));
        Self { problem, ground: Ground::new(Basis::default(), terms.response(), problem), library }
    }

    /// The effect in the form that explains most, and its share.
    pub fn best(&self) -> Option<(Term<'p>, f64)> {
        let shares = self.library.candidates.iter().map(|c| self.ground.own(&c.columns).share);
        let (best, _) = shares.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let mut term = [self.library.candidates[best].term(self.problem)];
        let left = polish(&mut term, &self.ground.basis, &self.ground.residual, self.problem);
        let [term] = term;
        Some((term, 1.0 - left / self.ground.energy))
    }
}

/// A memory effect of the model in its best form. `None` where there is nothing to choose it by.
pub fn form_of<'p>(problem: &'p Problem, given: Vec<f64>, spec: &'p ModelSpec, id: &str) -> Option<Term<'p>> {
    Some(Reversals::new(problem, given, spec, |other| other == id).best()?.0)
}
