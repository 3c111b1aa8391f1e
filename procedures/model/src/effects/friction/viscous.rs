//! Viscous friction.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Viscous;

pub(crate) const ID: &str = "viscous";

static INFO: EffectInfo = EffectInfo {
    id: ID,
    kind: Kind::Friction,
    title: "Viscous friction",
    sentence: "Friction of oil and grease, proportional to speed.",
    formula: "c_v·ω",
    source: "Armstrong-Hélouvry 1991",
    looks: "a line through zero over speed",
    parameters: &[parameter("c_v", "Nm·s/rad", 0.0, f64::INFINITY)],
    needs: &[],
};

impl Effect for Viscous {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["c_v"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.get(Signal::Velocity).to_vec()]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("velocity")
    }
}
