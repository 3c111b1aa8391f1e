//! Delay between torque and velocity.

use crate::effect::{EffectInfo, Regime, Traits, parameter};
use crate::effects::friction::inertia;
use crate::effects::linear::LinearEffect;
use crate::signal::Signal;
use jointbench_instrument::Kind;

pub(crate) const ID: &str = "signal_delay";

pub static SIGNAL_DELAY: LinearEffect = LinearEffect {
    info: EffectInfo {
        id: ID,
        kind: Kind::Friction,
        title: "Delay between torque and velocity",
        sentence: "Torque and motion are recorded at different times because of a drive delay, a filter or a flexible \
                   shaft.",
        formula: "k_j·dα/dt; k_j divided by the inertia is the delay",
        source: "Janot, Gautier, Brunot 2019, section 5 (flexibility); Taylor series of J·α(t + δ)",
        looks: "proportional to jerk: peaks at the start and end of each ramp",
        parameters: &[parameter("k_j", "kg·m²·s", f64::NEG_INFINITY, f64::INFINITY)],
        needs: &[],
    },
    column: |view| view.get(Signal::Jerk).to_vec(),
    symbolic: "jerk",
    traits: || Traits { regime: Regime::Transient, delay_of: Some(inertia::ID), ..Traits::default() },
};
