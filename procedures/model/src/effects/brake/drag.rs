//! Drag.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Drag;

pub(crate) const ID: &str = "drag";

static INFO: EffectInfo = EffectInfo {
    id: ID,
    kind: Kind::Brake,
    title: "Drag",
    sentence: "Bearings and remanence cause a small torque without current.",
    formula: "τ_0",
    source: "Data sheets of hysteresis brakes (residual drag)",
    looks: "a constant in all samples",
    parameters: &[parameter("tau_0", "Nm", 0.0, f64::INFINITY)],
    needs: &[],
};

impl Effect for Drag {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["tau_0"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![vec![1.0; view.len()]]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("1")
    }
}
