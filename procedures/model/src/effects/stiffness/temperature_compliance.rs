//! Temperature-dependent compliance.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct TemperatureCompliance;

static INFO: EffectInfo = EffectInfo {
    id: "temperature_compliance",
    kind: Kind::Stiffness,
    title: "Temperature-dependent compliance",
    sentence: "Compliance changes with temperature.",
    formula: "κ_T·(T − 25 °C)·τ",
    source: "JCGM 200:2012 (VIM), 4.22 variation due to an influence quantity; linearised about 25 °C",
    looks: "a line over torque whose slope changes with temperature",
    parameters: &[parameter("kappa_t", "rad/(Nm·K)", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &["temperature_c"],
};

impl Effect for TemperatureCompliance {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["kappa_t"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.map2(Signal::Temperature, Signal::Load, |c, t| (c - 25.0) * t)]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("(temperature - 25) * load")
    }

    fn traits(&self) -> Traits {
        Traits { over_time: Some("over_time: torsion = a * time * load; a [rad/(Nm·s)]"), ..Traits::default() }
    }
}
