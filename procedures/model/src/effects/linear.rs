//! Effects with one coefficient and one column.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits};
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;

/// An effect with one coefficient, its only parameter, and one column without nonlinear parameters.
pub struct LinearEffect {
    pub info: EffectInfo<'static>,
    /// The column at the points of a view.
    pub column: fn(&View) -> Vec<f64>,
    /// The column as a formula for a controller.
    pub symbolic: &'static str,
    pub traits: fn() -> Traits,
}

impl Effect for LinearEffect {
    fn info(&self) -> EffectInfo<'_> {
        self.info
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&[&self.info.parameters[0].name])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![(self.column)(view)]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula(self.symbolic)
    }

    fn traits(&self) -> Traits {
        (self.traits)()
    }
}
