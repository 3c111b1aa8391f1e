//! Cogging.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, orders, waves};
use crate::thresholds::COGGING_TURN;
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Cogging;

static INFO: EffectInfo = EffectInfo {
    id: "cogging",
    kind: Kind::Friction,
    title: "Cogging",
    sentence: "The magnets of the rotor are attracted by the stator teeth: the torque varies periodically with the \
               motor angle.",
    formula: "Σ a·cos(h·θ_m) + b·sin(h·θ_m), up to eight orders h estimated",
    source: "Hanselman 2003, ch. 7",
    looks: "periodic over the motor angle, equal in both directions, averaged out at high speed",
    parameters: &[
        parameter("a", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("b", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("harmonic", "1/turn", 1.0, 120.0),
    ],
    needs: &[],
};

impl Effect for Cogging {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    /// Not visible if the motor stayed at a few positions: a form error around the middle of a swing would look like
    /// a wave over them.
    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let mut forms = match view.constants.followed_hz {
            None if view.turned(Signal::Position) < COGGING_TURN => Vec::new(),
            _ => crate::effects::repeated_harmonic_form(view, Signal::Position, 1..=120),
        };
        forms.iter_mut().for_each(|f| f.name = crate::effects::SEVERAL_HARMONICS);
        forms
    }

    fn traits(&self) -> Traits {
        Traits { wave: Some(Signal::Position), ..Traits::default() }
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        shape.iter().flat_map(|h| view.harmonic(Signal::Position, *h)).collect()
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        Ok(waves("position", "", &orders(form)))
    }
    fn extended(&self, form: &Form) -> Option<(&'static str, Form<'static>)> {
        crate::effects::one_more_harmonic(form)
    }
}
