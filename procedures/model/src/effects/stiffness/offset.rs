//! Offset.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Offset;

static INFO: EffectInfo = EffectInfo {
    id: "offset",
    kind: Kind::Stiffness,
    title: "Offset",
    sentence: "The two encoders do not have the same zero.",
    formula: "ξ",
    source: "JCGM 200:2012 (VIM), 4.28 zero error",
    looks: "a constant in all samples",
    parameters: &[parameter("xi", "rad", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &[],
};

impl Effect for Offset {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["xi"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![vec![1.0; view.len()]]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("1")
    }
}
