//! Temperature drift.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct TemperatureDrift;

static INFO: EffectInfo = EffectInfo {
    id: "temperature_drift",
    kind: Kind::Encoder,
    title: "Temperature drift",
    sentence: "The zero drifts as the encoder warms up.",
    formula: "ξ_T·(T − 25 °C)",
    source: "JCGM 200:2012 (VIM), 4.22 variation due to an influence quantity",
    looks: "a line over temperature",
    parameters: &[parameter("xi_t", "rad/K", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &["temperature_c"],
};

impl Effect for TemperatureDrift {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["xi_t"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.map(Signal::Temperature, |t| t - 25.0)]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("temperature - 25")
    }

    fn traits(&self) -> Traits {
        Traits { over_time: Some("over_time: error = a * time; a [rad/s]"), ..Traits::default() }
    }
}
