//! Temperature-dependent Coulomb friction.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct TemperatureCoulomb;

static INFO: EffectInfo = EffectInfo {
    id: "temperature_coulomb",
    kind: Kind::Friction,
    title: "Temperature-dependent Coulomb friction",
    sentence: "Coulomb friction changes as the joint warms up.",
    formula: "τ_T·(T − 25 °C)·sign ω",
    source: "Bittencourt et al. 2010, linearised about 25 °C",
    looks: "a step at zero speed that changes with temperature",
    parameters: &[parameter("tau_t", "Nm/K", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &["temperature_c"],
};

impl Effect for TemperatureCoulomb {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["tau_t"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.map2(Signal::Temperature, Signal::Direction, |t, d| (t - 25.0) * d)]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("(temperature - 25) * direction")
    }

    fn traits(&self) -> Traits {
        Traits {
            over_time: Some("over_time: tau = a * time * direction; a [Nm/s]"),
            corrects: Some("coulomb"),
            ..Traits::default()
        }
    }
}
