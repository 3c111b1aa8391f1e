//! Every effect that the model does not have, in every form, at every starting point of its shape.

use crate::ModelSpec;
use crate::effect::{Effect, Form, Stage};
use crate::prepare::Problem;
use crate::report::Invisible;
use crate::terms::{Term, columns};

/// An effect in one form at one shape.
pub struct Candidate<'e> {
    pub effect: &'e dyn Effect,
    pub form: Form<'e>,
    pub shape: Vec<f64>,
    /// In single precision: they are many, and choose only where to look closer.
    pub columns: Vec<Vec<f32>>,
}

impl<'e> Candidate<'e> {
    pub fn id(&self) -> &'e str {
        self.effect.info().id
    }

    pub fn term(&self, problem: &Problem) -> Term<'e> {
        Term::new(self.effect, self.form.clone(), self.shape.clone(), problem)
    }
}

pub struct Library<'e> {
    pub candidates: Vec<Candidate<'e>>,
    pub invisible: Vec<Invisible>,
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
                    let columns = columns.into_iter().map(|c| c.into_iter().map(|v| v as f32).collect()).collect();
                    library.candidates.push(Candidate { effect, form: form.clone(), shape: shape.clone(), columns });
                }
            }
        }
        library
    }
}
