//! Temperature drift.

use crate::effect::{EffectInfo, Traits, parameter};
use crate::effects::linear::LinearEffect;
use crate::signal::Signal;
use jointbench_instrument::Kind;

pub static TEMPERATURE_DRIFT: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: "temperature_drift",
        kind: Kind::Encoder,
        title: "Temperature drift",
        sentence: "The zero drifts as the encoder warms up.",
        formula: "ξ_T·(T − 25 °C)",
        source: "JCGM 200:2012 (VIM), 4.22 variation due to an influence quantity",
        looks: "a line over temperature",
        parameters: &[parameter("xi_t", "rad/K", f64::NEG_INFINITY, f64::INFINITY)],
        needs: &["temperature_c"],
    },
    column: |view| view.map(Signal::Temperature, |t| t - 25.0),
    symbolic: "temperature - 25",
    traits: || Traits { over_time: Some("over_time: error = a * time; a [rad/s]"), ..Traits::default() },
};
