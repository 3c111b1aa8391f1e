//! Torque per current.

use crate::effect::{EffectInfo, Traits, parameter};
use crate::effects::linear::LinearEffect;
use crate::signal::Signal;
use jointbench_instrument::Kind;

pub static TORQUE_PER_CURRENT: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: "torque_per_current",
        kind: Kind::Brake,
        title: "Torque per current",
        sentence: "The braking torque grows in proportion to the coil current.",
        formula: "k_b·i",
        source: "Data sheets of hysteresis brakes (torque over current)",
        looks: "a line over current",
        parameters: &[parameter("k_b", "Nm/A", 0.0, f64::INFINITY)],
        needs: &[],
    },
    column: |view| view.get(Signal::Current).to_vec(),
    symbolic: "current",
    traits: Traits::default,
};
