//! Delay.

use crate::effect::{EffectInfo, Traits, parameter};
use crate::effects::linear::LinearEffect;
use crate::signal::Signal;
use jointbench_instrument::Kind;

pub static DELAY: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: "delay",
        kind: Kind::Encoder,
        title: "Delay",
        sentence: "The test encoder is read later than the reference. Its error grows in proportion to speed.",
        formula: "−t_d·ω",
        source: "First-order Taylor series of the position, θ(t − t_d) ≈ θ(t) − t_d·ω",
        looks: "a line through zero over speed",
        parameters: &[parameter("t_d", "s", f64::NEG_INFINITY, f64::INFINITY)],
        needs: &[],
    },
    column: |view| view.map(Signal::Velocity, |w| -w),
    symbolic: "-velocity",
    traits: Traits::default,
};
