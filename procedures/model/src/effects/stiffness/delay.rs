//! Delay.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Delay;

static INFO: EffectInfo = EffectInfo {
    id: "delay",
    kind: Kind::Stiffness,
    title: "Delay",
    sentence: "One encoder is read later than the other, so the apparent torsion grows with speed.",
    formula: "t_d·ω_link",
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

    fn traits(&self) -> Traits {
        Traits { needs_motion: true, ..Traits::default() }
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.get(Signal::Velocity).to_vec()]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("velocity")
    }
}
