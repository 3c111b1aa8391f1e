//! Compliance.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::signal::Signal;
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Compliance;

static INFO: EffectInfo = EffectInfo {
    id: "compliance",
    kind: Kind::Stiffness,
    title: "Compliance",
    sentence: "The joint twists in proportion to the torque, like a spring.",
    formula: "τ/k",
    source: "thesis on joint test benches, Δq = τ/k′ + β₀·sign τ",
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
}
