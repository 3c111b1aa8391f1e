//! Offset.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Offset;

static INFO: EffectInfo = EffectInfo {
    id: "offset",
    kind: Kind::Stiffness,
    title: "Offset",
    sentence: "The two encoders do not have the same zero.",
    formula: "ξ",
    source: "thesis on joint test benches, eq. of section 6",
    looks: "one constant everywhere",
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
}
