//! Directional offset.

use crate::effect::{EffectInfo, Traits, parameter};
use crate::effects::linear::LinearEffect;
use crate::signal::Signal;
use jointbench_instrument::Kind;

pub static DIRECTIONAL_OFFSET: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: "directional_offset",
        kind: Kind::Stiffness,
        title: "Directional offset",
        sentence: "The contact flank changes with the direction: a constant torsion that changes sign with the motion.",
        formula: "β₀·sign ω",
        source: "Nordin, Gutman 2002",
        looks: "a constant that changes sign with the motion",
        parameters: &[parameter("beta_0", "rad", f64::NEG_INFINITY, f64::INFINITY)],
        needs: &[],
    },
    column: |view| view.get(Signal::Direction).to_vec(),
    symbolic: "direction",
    traits: || Traits { needs_motion: true, ..Traits::default() },
};
