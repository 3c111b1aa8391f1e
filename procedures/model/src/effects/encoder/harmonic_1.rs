//! Eccentricity.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, waves};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Harmonic1;

static INFO: EffectInfo = EffectInfo {
    id: "harmonic_1",
    kind: Kind::Encoder,
    title: "Eccentricity",
    sentence: "The ring or the sensor is eccentric: one period per turn.",
    formula: "a·cos θ + b·sin θ",
    source: "Masuda, Kajitani 1989",
    looks: "one period per turn",
    parameters: &[
        parameter("a", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("b", "rad", f64::NEG_INFINITY, f64::INFINITY),
    ],
    needs: &[],
};

impl Effect for Harmonic1 {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        if crate::effects::is_repeated(view, Signal::Position, 1) {
            vec![Form::linear(&["a", "b"])]
        } else {
            Vec::new()
        }
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        view.harmonic(Signal::Position, 1.0).into()
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        Ok(waves("position", "", &["1"]))
    }
}
