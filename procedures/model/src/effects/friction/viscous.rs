//! Viscous friction.

use crate::effect::{EffectInfo, Traits, parameter};
use crate::effects::linear::LinearEffect;
use crate::signal::Signal;
use jointbench_instrument::Kind;

pub(crate) const ID: &str = "viscous";

pub static VISCOUS: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: ID,
        kind: Kind::Friction,
        title: "Viscous friction",
        sentence: "Friction of oil and grease, proportional to speed.",
        formula: "c_v·ω",
        source: "Armstrong-Hélouvry 1991",
        looks: "a line through zero over speed",
        parameters: &[parameter("c_v", "Nm·s/rad", 0.0, f64::INFINITY)],
        needs: &[],
    },
    column: |view| view.get(Signal::Velocity).to_vec(),
    symbolic: "velocity",
    traits: Traits::default,
};
