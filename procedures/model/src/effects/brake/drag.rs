//! Drag.

use crate::effect::{EffectInfo, Traits, parameter};
use crate::effects::linear::LinearEffect;
use jointbench_instrument::Kind;

pub(crate) const ID: &str = "drag";

pub static DRAG: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: ID,
        kind: Kind::Brake,
        title: "Drag",
        sentence: "Bearings and remanence cause a small torque without current.",
        formula: "τ_0",
        source: "Data sheets of hysteresis brakes (residual drag)",
        looks: "a constant in all samples",
        parameters: &[parameter("tau_0", "Nm", 0.0, f64::INFINITY)],
        needs: &[],
    },
    column: |view| vec![1.0; view.len()],
    symbolic: "1",
    traits: Traits::default,
};
