//! Delay.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::signal::Signal;
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Delay;

static INFO: EffectInfo = EffectInfo {
    id: "delay",
    kind: Kind::Encoder,
    title: "Delay",
    sentence: "The test encoder answers later than the reference, so it lags the more the faster the shaft turns.",
    formula: "−t_d·ω",
    source: "thesis on joint test benches, eq. 4.4–4.5",
    looks: "a line through zero over speed",
    parameters: &[parameter("t_d", "s", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &[],
};

impl Effect for Delay {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["t_d"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.map(Signal::Velocity, |w| -w)]
    }
}
