//! Velocity dependence.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct VelocityDependence;

static INFO: EffectInfo = EffectInfo {
    id: "velocity_dependence",
    kind: Kind::Brake,
    title: "Velocity dependence",
    sentence: "The brake holds more or less at higher speed: eddy currents and windage.",
    formula: "c_v·ω, or c_v·i·ω",
    source: "makers' data of hysteresis brakes (eddy currents)",
    looks: "a line over speed",
    parameters: &[parameter("c_v", "Nm·s/rad", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &["velocity_rad_s"],
};

impl Effect for VelocityDependence {
    fn info(&self) -> &'static EffectInfo {
        &INFO
    }

    fn forms(&self, _: &View) -> Vec<Form> {
        ["plain", "excited"]
            .map(|name| Form { name, linear: &["c_v"], shape: Vec::new(), grid: vec![Vec::new()] })
            .into()
    }

    fn columns(&self, form: &str, _: &[f64], view: &View) -> Columns {
        vec![match form {
            "plain" => view.get(Signal::Velocity).to_vec(),
            _ => view.map2(Signal::Velocity, Signal::Current, |w, i| w * i),
        }]
    }
}
