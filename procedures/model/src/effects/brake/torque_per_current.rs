//! Torque per current.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct TorquePerCurrent;

static INFO: EffectInfo = EffectInfo {
    id: "torque_per_current",
    kind: Kind::Brake,
    title: "Torque per current",
    sentence: "The braking torque grows in proportion to the coil current.",
    formula: "k_b·i",
    source: "Data sheets of hysteresis brakes (torque over current)",
    looks: "a line over current",
    parameters: &[parameter("k_b", "Nm/A", 0.0, f64::INFINITY)],
    needs: &[],
};

impl Effect for TorquePerCurrent {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["k_b"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.get(Signal::Current).to_vec()]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("current")
    }
}
