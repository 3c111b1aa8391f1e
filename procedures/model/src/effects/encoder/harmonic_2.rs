//! Tilt or ellipticity.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, waves};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Harmonic2;

static INFO: EffectInfo = EffectInfo {
    id: "harmonic_2",
    kind: Kind::Encoder,
    title: "Tilt or ellipticity",
    sentence: "Two periods per turn: the ring is tilted or elliptical, or the amplitudes of the sine and cosine differ.",
    formula: "a·cos 2θ + b·sin 2θ",
    source: "Masuda, Kajitani 1989",
    looks: "two periods per turn",
    parameters: &[
        parameter("a", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("b", "rad", f64::NEG_INFINITY, f64::INFINITY),
    ],
    needs: &[],
};

impl Effect for Harmonic2 {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        if crate::effects::is_repeated(view, Signal::Position, 2) {
            vec![Form::linear(&["a", "b"])]
        } else {
            Vec::new()
        }
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        view.harmonic(Signal::Position, 2.0).into()
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        Ok(waves("position", "", &["2"]))
    }
}
