//! Temperature-dependent compliance.

use crate::effect::{EffectInfo, Traits, parameter};
use crate::effects::linear::LinearEffect;
use crate::signal::Signal;
use jointbench_instrument::Kind;

pub static TEMPERATURE_COMPLIANCE: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: "temperature_compliance",
        kind: Kind::Stiffness,
        title: "Temperature-dependent compliance",
        sentence: "Compliance changes with temperature.",
        formula: "κ_T·(T − 25 °C)·τ",
        source: "JCGM 200:2012 (VIM), 4.22 variation due to an influence quantity; linearised about 25 °C",
        looks: "a line over torque whose slope changes with temperature",
        parameters: &[parameter("kappa_t", "rad/(Nm·K)", f64::NEG_INFINITY, f64::INFINITY)],
        needs: &["temperature_c"],
    },
    column: |view| view.map2(Signal::Temperature, Signal::Load, |c, t| (c - 25.0) * t),
    symbolic: "(temperature - 25) * load",
    traits: || Traits { over_time: Some("over_time: torsion = a * time * load; a [rad/(Nm·s)]"), ..Traits::default() },
};
