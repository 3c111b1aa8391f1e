//! Directional offset.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct DirectionalOffset;

static INFO: EffectInfo = EffectInfo {
    id: "directional_offset",
    kind: Kind::Stiffness,
    title: "Directional offset",
    sentence: "The contact flank changes with the direction: a constant torsion that changes sign with the motion.",
    formula: "β₀·sign ω",
    source: "Nordin, Gutman 2002",
    looks: "a constant that changes sign with the motion",
    parameters: &[parameter("beta_0", "rad", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &[],
};

impl Effect for DirectionalOffset {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["beta_0"])]
    }

    fn traits(&self) -> Traits {
        Traits { needs_motion: true, ..Traits::default() }
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.get(Signal::Direction).to_vec()]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("direction")
    }
}
