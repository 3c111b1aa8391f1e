//! Cogging.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, orders, waves};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Cogging;

static INFO: EffectInfo = EffectInfo {
    id: "cogging",
    kind: Kind::Brake,
    title: "Cogging",
    sentence: "Remanent poles in the rotor of the brake: the torque varies periodically with the shaft angle.",
    formula: "a·cos(p·θ) + b·sin(p·θ), p estimated",
    source: "Data sheets of hysteresis brakes (cogging, salient poles)",
    looks: "periodic over the shaft angle",
    parameters: &[
        parameter("a", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("b", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("harmonic", "1/turn", 1.0, 120.0),
    ],
    needs: &["position_rad"],
};

impl Effect for Cogging {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        // The order of known poles needs no search, so that aliasing does not limit it.
        let mut forms = match (view.constants.poles, view.samples.find(Signal::Position)) {
            (Some(poles), Some(_)) => crate::effects::known_order(poles),
            _ => crate::effects::harmonic_form(view, Signal::Position, 1..=60),
        };
        let excited = forms.iter().map(|f| Form { name: "excited", ..f.clone() }).collect::<Vec<_>>();
        forms.extend(excited);
        forms
    }

    fn traits(&self) -> Traits {
        Traits { wave: Some(Signal::Position), ..Traits::default() }
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        let mut columns = view.harmonic(Signal::Position, shape[0]);
        if form == "excited" {
            let current = view.get(Signal::Current);
            columns.iter_mut().for_each(|c| c.iter_mut().zip(current).for_each(|(c, i)| *c *= i));
        }
        columns.into()
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        let times = if form.name == "excited" { " * current" } else { "" };
        Ok(waves("position", times, &orders(form)))
    }
}
