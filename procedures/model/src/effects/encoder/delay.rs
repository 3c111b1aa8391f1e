//! Delay.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Delay;

static INFO: EffectInfo = EffectInfo {
    id: "delay",
    kind: Kind::Encoder,
    title: "Delay",
    sentence: "The test encoder is read later than the reference. Its error grows in proportion to speed.",
    formula: "−t_d·ω",
    source: "First-order Taylor series of the position, θ(t − t_d) ≈ θ(t) − t_d·ω",
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

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("-velocity")
    }
}
