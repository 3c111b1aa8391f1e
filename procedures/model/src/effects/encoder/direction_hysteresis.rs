//! Direction hysteresis.

use crate::effect::{EffectInfo, Traits, parameter};
use crate::effects::linear::LinearEffect;
use crate::signal::Signal;
use jointbench_instrument::Kind;

pub static DIRECTION_HYSTERESIS: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: "direction_hysteresis",
        kind: Kind::Encoder,
        title: "Direction hysteresis",
        sentence: "The reading depends on the direction of approach because of play in the coupling or magnetic \
                   hysteresis.",
        formula: "h·sign ω",
        source: "ISO 230-2:2014, reversal error",
        looks: "a constant that changes sign with the direction",
        parameters: &[parameter("h", "rad", f64::NEG_INFINITY, f64::INFINITY)],
        needs: &[],
    },
    column: |view| view.get(Signal::Direction).to_vec(),
    symbolic: "direction",
    traits: Traits::default,
};
