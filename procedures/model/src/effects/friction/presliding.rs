//! Presliding hysteresis.

use crate::effect::{Columns, Effect, EffectInfo, Form, Search, Shape, parameter};
use crate::effects::memory;
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct Presliding;

static INFO: EffectInfo = EffectInfo {
    id: "presliding",
    kind: Kind::Friction,
    title: "Presliding hysteresis",
    sentence: "After a reversal the contacts bend like bristles before they slip: friction builds up over a short way.",
    formula: "τ_p·(z − sgn ω), dz = (1 − z·sgn ω)·dθ/θ_p (Dahl); or a stop, dz = dθ/θ_p within ±1 (generalised Maxwell slip)",
    source: "Dahl 1968; Al-Bender, Lampaert, Swevers 2005",
    looks: "loops at reversals: the torque arrives later than the direction changes",
    parameters: &[parameter("tau_p", "Nm", 0.0, f64::INFINITY), parameter("theta_p", "rad", 0.0, f64::INFINITY)],
    needs: &[],
};

impl Effect for Presliding {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let Some((low, high)) = crate::effects::reversal_range(view) else { return Vec::new() };
        let shape = vec![Shape { name: "theta_p", min: low, max: high, search: Search::Smooth }];
        let grid: Vec<Vec<f64>> = crate::effects::log_grid(low, high, 7).into_iter().map(|d| vec![d]).collect();
        ["dahl", "stop"]
            .map(|name| Form { name, linear: vec!["tau_p"], shape: shape.clone(), grid: grid.clone() })
            .into()
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        let position = view.samples.find(Signal::Position).unwrap_or_default();
        let state = match form {
            "dahl" => memory::dahl(position, shape[0], &view.starts),
            _ => memory::stop(position, shape[0], &view.starts),
        };
        let direction = view.samples.find(Signal::Direction).unwrap_or_default();
        vec![view.average(state.iter().zip(direction).map(|(z, d)| z - d).collect())]
    }

    fn stage(&self) -> crate::effect::Stage {
        crate::effect::Stage::Memory
    }
}
