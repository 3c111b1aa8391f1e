//! Delay.

use crate::effect::{EffectInfo, Traits, parameter};
use crate::effects::linear::LinearEffect;
use crate::signal::Signal;
use jointbench_instrument::Kind;

pub static DELAY: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: "delay",
        kind: Kind::Stiffness,
        title: "Delay",
        sentence: "One encoder is read later than the other, so the apparent torsion grows with speed.",
        formula: "t_d·ω_link",
        source: "First-order Taylor series of the position, θ(t − t_d) ≈ θ(t) − t_d·ω",
        looks: "a line through zero over speed",
        parameters: &[parameter("t_d", "s", f64::NEG_INFINITY, f64::INFINITY)],
        needs: &[],
    },
    column: |view| view.get(Signal::Velocity).to_vec(),
    symbolic: "velocity",
    traits: || Traits { needs_motion: true, ..Traits::default() },
};
