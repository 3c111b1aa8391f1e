//! Delay between torque and velocity.

use crate::effect::{Columns, Effect, EffectInfo, Form, Regime, Traits, parameter};
use crate::effects::friction::inertia;
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct SignalDelay;

pub(crate) const ID: &str = "signal_delay";

static INFO: EffectInfo = EffectInfo {
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
};

impl Effect for SignalDelay {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["k_j"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.get(Signal::Jerk).to_vec()]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("jerk")
    }

    fn traits(&self) -> Traits {
        Traits { regime: Regime::Transient, delay_of: Some(inertia::ID), ..Traits::default() }
    }
}
