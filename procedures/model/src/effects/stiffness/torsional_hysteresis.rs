//! Torsional hysteresis.

use crate::effect::{Columns, Effect, EffectInfo, Form, Search, Shape, parameter};
use crate::effects::memory;
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct TorsionalHysteresis;

static INFO: EffectInfo = EffectInfo {
    id: "torsional_hysteresis",
    kind: Kind::Stiffness,
    title: "Torsional hysteresis",
    sentence: "The twist depends on how the torque came about: on the way up it lags, on the way down too.",
    formula: "η·z, dz = (1 − z·sgn dτ)·dτ/τ_η (Dahl), or a stop dz = dτ/τ_η within ±1, or the mean of four stops with reaches up to τ_η (Maxwell slip)",
    source: "Dahl 1968; Ruderman, Bertram, Iwasaki 2014",
    looks: "loops over torque",
    parameters: &[parameter("eta", "rad", 0.0, f64::INFINITY), parameter("tau_eta", "Nm", 0.0, f64::INFINITY)],
    needs: &[],
};

impl Effect for TorsionalHysteresis {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let peak = view.peak(Signal::Load);
        let shape = vec![Shape { name: "tau_eta", min: 0.004 * peak, max: peak, search: Search::Smooth }];
        let grid: Vec<Vec<f64>> =
            crate::effects::log_grid(0.004 * peak, peak, 9).into_iter().map(|t| vec![t]).collect();
        let one = |name| Form { name, linear: vec!["eta"], shape: shape.clone(), grid: grid.clone() };
        vec![one("dahl"), one("stop"), one("maxwell_slip")]
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        let torque = view.samples.find(Signal::Load).unwrap_or_default();
        let state = match form {
            "dahl" => memory::dahl(torque, shape[0], &view.starts),
            "maxwell_slip" => memory::maxwell_slip(torque, shape[0], &view.starts),
            _ => memory::stop(torque, shape[0], &view.starts),
        };
        vec![view.average(state)]
    }
}
