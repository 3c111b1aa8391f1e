//! Compliance.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Compliance;

static INFO: EffectInfo = EffectInfo {
    id: "compliance",
    kind: Kind::Stiffness,
    title: "Compliance",
    sentence: "Torsion is proportional to the torque, as in a spring.",
    formula: "τ/k",
    source: "Kircanski, Goldenberg 1997",
    looks: "a line over torque",
    parameters: &[parameter("inverse_k", "rad/Nm", 0.0, f64::INFINITY)],
    needs: &[],
};

impl Effect for Compliance {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["inverse_k"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.get(Signal::Load).to_vec()]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("load")
    }
}
