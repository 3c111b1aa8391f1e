//! Temperature dependence.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::effects::brake::scaled;
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct TemperatureDependence;

static INFO: EffectInfo = EffectInfo {
    id: "temperature_dependence",
    kind: Kind::Brake,
    title: "Temperature dependence",
    sentence: "The braking torque decreases as the brake warms up.",
    formula: "c_T·(T − 25 °C), or times i, or c_T·(T − T_0)·τ with the torque τ that current and history explain at T_0",
    source: "Data sheets of hysteresis brakes (temperature coefficient)",
    looks: "a line over temperature",
    parameters: &[
        parameter("c_t", "Nm/K", f64::NEG_INFINITY, f64::INFINITY),
        parameter("c_t_i", "Nm/(A·K)", f64::NEG_INFINITY, f64::INFINITY),
        parameter("c_t_tau", "1/K", f64::NEG_INFINITY, f64::INFINITY),
        parameter("t_0", "°C", f64::NEG_INFINITY, f64::INFINITY),
    ],
    needs: &["temperature_c"],
};

impl Effect for TemperatureDependence {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let form = |name, linear| Form { name, ..Form::linear(linear) };
        let usual = scaled::usual(view, Signal::Temperature, |t| t);
        vec![form("plain", &["c_t"]), form("excited", &["c_t_i"]), scaled::form("c_t_tau", "t_0", usual)]
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        vec![match form {
            "plain" => view.map(Signal::Temperature, |t| t - 25.0),
            "excited" => view.map2(Signal::Temperature, Signal::Current, |t, i| (t - 25.0) * i),
            _ => view.map2(Signal::Temperature, Signal::Drive, |t, d| (t - shape[0]) * d),
        }]
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        match form.name {
            "plain" => formula("temperature - 25"),
            "excited" => formula("(temperature - 25) * current"),
            _ => Err(scaled::NOT_IN_A_CONTROLLER),
        }
    }
}
