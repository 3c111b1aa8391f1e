//! Coulomb friction.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Coulomb;

pub(crate) const ID: &str = "coulomb";

static INFO: EffectInfo = EffectInfo {
    id: ID,
    kind: Kind::Friction,
    title: "Coulomb friction",
    sentence: "A constant torque against the motion, independent of speed.",
    formula: "τ_c·sign ω",
    source: "Armstrong-Hélouvry 1991",
    looks: "a step at zero speed",
    parameters: &[parameter("tau_c", "Nm", 0.0, f64::INFINITY)],
    needs: &[],
};

impl Effect for Coulomb {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["tau_c"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.get(Signal::Direction).to_vec()]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("direction")
    }
}
