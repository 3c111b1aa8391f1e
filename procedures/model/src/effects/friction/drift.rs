//! Drift with time.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct Drift;

static INFO: EffectInfo = EffectInfo {
    id: "drift",
    kind: Kind::Friction,
    title: "Drift with time",
    sentence: "Something changes slowly from the first sample to the last, such as the zero of a sensor.",
    formula: "d·t, zero at the first sample",
    source: "contract section 2",
    looks: "a line over time, the same in both directions",
    parameters: &[parameter("d", "Nm/s", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &[],
};

impl Effect for Drift {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["d"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.get(Signal::Time).to_vec()]
    }
}
