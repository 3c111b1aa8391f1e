//! Rotor inertia.

use crate::effect::{EffectInfo, Regime, Traits, parameter};
use crate::effects::linear::LinearEffect;
use crate::signal::Signal;
use jointbench_instrument::Kind;

pub(crate) const ID: &str = "inertia";

pub static INERTIA: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: ID,
        kind: Kind::Friction,
        title: "Rotor inertia",
        sentence: "Torque that accelerates the rotor and the parts that turn with it.",
        formula: "J·α",
        source: "Newton's second law; Gautier 1997",
        looks: "proportional to acceleration: large in transients, zero at constant speed",
        parameters: &[parameter("j", "kg·m²", 0.0, f64::INFINITY)],
        needs: &[],
    },
    column: |view| view.get(Signal::Acceleration).to_vec(),
    symbolic: "acceleration",
    traits: || Traits { regime: Regime::Transient, ..Traits::default() },
};
