//! Transmission error.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, orders, waves};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct TransmissionError;

static INFO: EffectInfo = EffectInfo {
    id: "transmission_error",
    kind: Kind::Stiffness,
    title: "Transmission error",
    sentence: "Pitch errors of the teeth: torsion varies periodically with the link angle.",
    formula: "a·cos(h·θ_link) + b·sin(h·θ_link), h estimated",
    source: "Tuttle, Seering 1996",
    looks: "periodic over the link angle, equal at all torques",
    parameters: &[
        parameter("a", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("b", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("harmonic", "1/turn", 1.0, 60.0),
    ],
    needs: &[],
};

impl Effect for TransmissionError {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        crate::effects::harmonic_form(view, Signal::Link, 1..=60)
    }

    fn traits(&self) -> Traits {
        Traits { wave: Some(Signal::Link), needs_motion: true, ..Traits::default() }
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        view.harmonic(Signal::Link, shape[0]).into()
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        Ok(waves("link_position", "", &orders(form)))
    }
}
