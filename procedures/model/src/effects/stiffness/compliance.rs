//! Compliance.

use crate::effect::{EffectInfo, Traits, parameter};
use crate::effects::linear::LinearEffect;
use crate::signal::Signal;
use jointbench_instrument::Kind;

pub static COMPLIANCE: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: "compliance",
        kind: Kind::Stiffness,
        title: "Compliance",
        sentence: "Torsion is proportional to the torque, as in a spring.",
        formula: "τ/k",
        source: "Kircanski, Goldenberg 1997",
        looks: "a line over torque",
        parameters: &[parameter("inverse_k", "rad/Nm", 0.0, f64::INFINITY)],
        needs: &[],
    },
    column: |view| view.get(Signal::Load).to_vec(),
    symbolic: "load",
    traits: Traits::default,
};
