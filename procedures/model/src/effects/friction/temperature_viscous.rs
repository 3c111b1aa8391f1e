//! Temperature-dependent viscous friction.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct TemperatureViscous;

static INFO: EffectInfo = EffectInfo {
    id: "temperature_viscous",
    kind: Kind::Friction,
    title: "Temperature-dependent viscous friction",
    sentence: "Warm grease is less viscous: viscous friction decreases as the joint warms up.",
    formula: "c_T·(T − 25 °C)·ω",
    source: "Bittencourt et al. 2010, linearised about 25 °C",
    looks: "a line over speed whose slope changes with temperature",
    parameters: &[parameter("c_t", "Nm·s/(rad·K)", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &["temperature_c"],
};

impl Effect for TemperatureViscous {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["c_t"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.map2(Signal::Temperature, Signal::Velocity, |t, w| (t - 25.0) * w)]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("(temperature - 25) * velocity")
    }

    fn traits(&self) -> Traits {
        Traits {
            over_time: Some("over_time: tau = a * time * velocity; a [Nm/rad]"),
            corrects: Some("viscous"),
            ..Traits::default()
        }
    }
}
