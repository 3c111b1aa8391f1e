//! Rotor inertia.

use crate::effect::{Columns, Effect, EffectInfo, Form, Regime, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Inertia;

pub(crate) const ID: &str = "inertia";

static INFO: EffectInfo = EffectInfo {
    id: ID,
    kind: Kind::Friction,
    title: "Rotor inertia",
    sentence: "Torque that accelerates the rotor and the parts that turn with it.",
    formula: "J·α",
    source: "Newton's second law; Gautier 1997",
    looks: "proportional to acceleration: large in transients, zero at constant speed",
    parameters: &[parameter("j", "kg·m²", 0.0, f64::INFINITY)],
    needs: &[],
};

impl Effect for Inertia {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["j"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.get(Signal::Acceleration).to_vec()]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("acceleration")
    }

    fn traits(&self) -> Traits {
        Traits { regime: Regime::Transient, ..Traits::default() }
    }
}
