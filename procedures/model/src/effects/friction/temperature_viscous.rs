//! Temperature-dependent viscous friction.

use crate::effect::{EffectInfo, Traits, parameter};
use crate::effects::linear::LinearEffect;
use crate::signal::Signal;
use jointbench_instrument::Kind;

pub static TEMPERATURE_VISCOUS: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: "temperature_viscous",
        kind: Kind::Friction,
        title: "Temperature-dependent viscous friction",
        sentence: "Warm grease is less viscous: viscous friction decreases as the joint warms up.",
        formula: "c_T·(T − 25 °C)·ω",
        source: "Bittencourt et al. 2010, linearised about 25 °C",
        looks: "a line over speed whose slope changes with temperature",
        parameters: &[parameter("c_t", "Nm·s/(rad·K)", f64::NEG_INFINITY, f64::INFINITY)],
        needs: &["temperature_c"],
    },
    column: |view| view.map2(Signal::Temperature, Signal::Velocity, |t, w| (t - 25.0) * w),
    symbolic: "(temperature - 25) * velocity",
    traits: || Traits {
        over_time: Some("over_time: tau = a * time * velocity; a [Nm/rad]"),
        corrects: Some("viscous"),
        ..Traits::default()
    },
};
