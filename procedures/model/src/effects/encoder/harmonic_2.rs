//! Tilt or ellipticity.

use crate::effect::EffectInfo;
use crate::effects::encoder::fixed_harmonic::{FixedHarmonic, PARAMETERS};
use jointbench_instrument::Kind;

pub static HARMONIC_2: FixedHarmonic = FixedHarmonic {
    info: EffectInfo {
        id: "harmonic_2",
        kind: Kind::Encoder,
        title: "Tilt or ellipticity",
        sentence: "Two periods per turn: the ring is tilted or elliptical, or the amplitudes of the sine and cosine differ.",
        formula: "a·cos 2θ + b·sin 2θ",
        source: "Masuda, Kajitani 1989",
        looks: "two periods per turn",
        parameters: PARAMETERS,
        needs: &[],
    },
    order: 2,
};
