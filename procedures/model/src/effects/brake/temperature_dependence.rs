//! Temperature dependence.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct TemperatureDependence;

static INFO: EffectInfo = EffectInfo {
    id: "temperature_dependence",
    kind: Kind::Brake,
    title: "Temperature dependence",
    sentence: "A warm brake holds less.",
    formula: "c_T·(T − 25 °C), or c_T·(T − 25 °C)·i",
    source: "makers' data of hysteresis brakes",
    looks: "a line over temperature",
    parameters: &[parameter("c_t", "Nm/K", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &["temperature_c"],
};

impl Effect for TemperatureDependence {
    fn info(&self) -> &'static EffectInfo {
        &INFO
    }

    fn forms(&self, _: &View) -> Vec<Form> {
        ["plain", "excited"]
            .map(|name| Form { name, linear: &["c_t"], shape: Vec::new(), grid: vec![Vec::new()] })
            .into()
    }

    fn columns(&self, form: &str, _: &[f64], view: &View) -> Columns {
        vec![match form {
            "plain" => view.map(Signal::Temperature, |t| t - 25.0),
            _ => view.map2(Signal::Temperature, Signal::Current, |t, i| (t - 25.0) * i),
        }]
    }
}
