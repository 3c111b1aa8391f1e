//! Effects that are one harmonic of the angle.

use crate::effect::{Columns, Effect, EffectInfo, Form, ParameterInfo, parameter};
use crate::effects::is_repeated;
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, waves};
use crate::view::View;

/// Amplitudes of the cosine and of the sine.
pub const PARAMETERS: &[ParameterInfo] =
    &[parameter("a", "rad", f64::NEG_INFINITY, f64::INFINITY), parameter("b", "rad", f64::NEG_INFINITY, f64::INFINITY)];

/// A cosine and a sine with a fixed number of periods per turn.
pub struct FixedHarmonic {
    pub info: EffectInfo<'static>,
    /// Periods per turn.
    pub order: u32,
}

impl Effect for FixedHarmonic {
    fn info(&self) -> EffectInfo<'_> {
        self.info
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let is_visible = is_repeated(view, Signal::Position, self.order);
        is_visible.then(|| Form::linear(&["a", "b"])).into_iter().collect()
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        view.harmonic(Signal::Position, f64::from(self.order)).into()
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        Ok(waves("position", "", &[self.order.to_string()]))
    }
}
