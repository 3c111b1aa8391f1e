//! Eccentricity.

use crate::effect::EffectInfo;
use crate::effects::encoder::fixed_harmonic::{FixedHarmonic, PARAMETERS};
use jointbench_instrument::Kind;

pub static HARMONIC_1: FixedHarmonic = FixedHarmonic {
    info: EffectInfo {
        id: "harmonic_1",
        kind: Kind::Encoder,
        title: "Eccentricity",
        sentence: "The ring or the sensor is eccentric: one period per turn.",
        formula: "a·cos θ + b·sin θ",
        source: "Masuda, Kajitani 1989",
        looks: "one period per turn",
        parameters: PARAMETERS,
        needs: &[],
    },
    order: 1,
};
