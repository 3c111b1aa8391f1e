//! Temperature-dependent Coulomb friction.

use crate::effect::{EffectInfo, Traits, parameter};
use crate::effects::linear::LinearEffect;
use crate::signal::Signal;
use jointbench_instrument::Kind;

pub static TEMPERATURE_COULOMB: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: "temperature_coulomb",
        kind: Kind::Friction,
        title: "Temperature-dependent Coulomb friction",
        sentence: "Coulomb friction changes as the joint warms up.",
        formula: "τ_T·(T − 25 °C)·sign ω",
        source: "Bittencourt et al. 2010, linearised about 25 °C",
        looks: "a step at zero speed that changes with temperature",
        parameters: &[parameter("tau_t", "Nm/K", f64::NEG_INFINITY, f64::INFINITY)],
        needs: &["temperature_c"],
    },
    column: |view| view.map2(Signal::Temperature, Signal::Direction, |t, d| (t - 25.0) * d),
    symbolic: "(temperature - 25) * direction",
    traits: || Traits {
        over_time: Some("over_time: tau = a * time * direction; a [Nm/s]"),
        corrects: Some("coulomb"),
        ..Traits::default()
    },
};
