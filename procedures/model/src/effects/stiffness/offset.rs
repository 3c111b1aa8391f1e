//! Offset.

use crate::effect::{EffectInfo, Traits, parameter};
use crate::effects::linear::LinearEffect;
use jointbench_instrument::Kind;

pub static OFFSET: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: "offset",
        kind: Kind::Stiffness,
        title: "Offset",
        sentence: "The two encoders do not have the same zero.",
        formula: "ξ",
        source: "JCGM 200:2012 (VIM), 4.28 zero error",
        looks: "a constant in all samples",
        parameters: &[parameter("xi", "rad", f64::NEG_INFINITY, f64::INFINITY)],
        needs: &[],
    },
    column: |view| vec![1.0; view.len()],
    symbolic: "1",
    traits: Traits::default,
};
