//! Higher harmonic.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, orders, waves};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct HarmonicN;

static INFO: EffectInfo = EffectInfo {
    id: "harmonic_n",
    kind: Kind::Encoder,
    title: "Higher harmonic",
    sentence: "A mechanical or magnetic error that repeats several times per turn.",
    formula: "a·cos(h·θ) + b·sin(h·θ), h ≥ 3 estimated",
    source: "Masuda, Kajitani 1989",
    looks: "several periods per turn",
    parameters: &[
        parameter("a", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("b", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("harmonic", "1/turn", 3.0, 120.0),
    ],
    needs: &[],
};

impl Effect for HarmonicN {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let poles = view.constants.pole_pairs.map(f64::from);
        let own = |h: f64| poles.is_some_and(|p| h == p || h == 2.0 * p);
        let mut forms =
            crate::effects::repeated_harmonic_form(view, Signal::Position, 3..=if poles.is_some() { 120 } else { 15 });
        forms.iter_mut().for_each(|f| f.grid.retain(|h| !own(h[0])));
        forms
    }

    fn traits(&self) -> Traits {
        Traits { wave: Some(Signal::Position), ..Traits::default() }
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        view.harmonic(Signal::Position, shape[0]).into()
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        Ok(waves("position", "", &orders(form)))
    }
}
