//! Coulomb friction.

use crate::effect::{EffectInfo, Traits, parameter};
use crate::effects::linear::LinearEffect;
use crate::signal::Signal;
use jointbench_instrument::Kind;

pub(crate) const ID: &str = "coulomb";

pub static COULOMB: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: ID,
        kind: Kind::Friction,
        title: "Coulomb friction",
        sentence: "A constant torque against the motion, independent of speed.",
        formula: "τ_c·sign ω",
        source: "Armstrong-Hélouvry 1991",
        looks: "a step at zero speed",
        parameters: &[parameter("tau_c", "Nm", 0.0, f64::INFINITY)],
        needs: &[],
    },
    column: |view| view.get(Signal::Direction).to_vec(),
    symbolic: "direction",
    traits: Traits::default,
};
