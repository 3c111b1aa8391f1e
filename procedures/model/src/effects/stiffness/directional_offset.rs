//! Directional offset.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::signal::Signal;
use crate::view::View;
use jointbench_instrument::Kind;

pub struct DirectionalOffset;

static INFO: EffectInfo = EffectInfo {
    id: "directional_offset",
    kind: Kind::Stiffness,
    title: "Directional offset",
    sentence: "The joint rests on the other flank when it turns the other way: a constant twist with the sign of the motion.",
    formula: "β₀·sign ω",
    source: "thesis on joint test benches, β₀",
    looks: "the same constant, with the sign of the motion",
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

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.get(Signal::Direction).to_vec()]
    }
}
