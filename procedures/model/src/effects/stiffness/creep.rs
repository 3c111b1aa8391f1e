//! Creep.

use crate::effect::{Columns, Effect, EffectInfo, Form, Shape, ShapeSearch, parameter};
use crate::hysteresis_operators;
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Rule, Symbolic, memory};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Creep;

static INFO: EffectInfo = EffectInfo {
    id: "creep",
    kind: Kind::Stiffness,
    title: "Creep",
    sentence: "Under a constant load the torsion keeps increasing for some time.",
    formula: "κ_c·(s − τ), ds = (τ − s)·dt/t_c",
    source: "Findley, Lai, Onaran 1976, standard linear solid",
    looks: "torsion lags behind the torque",
    parameters: &[parameter("kappa_c", "rad/Nm", 0.0, f64::INFINITY), parameter("t_c", "s", 0.0, f64::INFINITY)],
    needs: &[],
};

impl Effect for Creep {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let step = view.sample_s;
        let (low, high) = (5.0 * step, 0.2 * step * view.samples.len() as f64);
        if high <= 2.0 * low {
            return Vec::new();
        }
        let shape = vec![Shape { name: "t_c", min: low, max: high, search: ShapeSearch::Smooth }];
        let grid = crate::effects::log_grid(low, high, 8).into_iter().map(|t| vec![t]).collect();
        vec![Form { name: "lag", linear: vec!["kappa_c"], shape, grid }]
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        let torque = view.samples.find(Signal::Load).unwrap_or_default();
        let lag = hysteresis_operators::lag(torque, view.sample_s / shape[0], &view.starts);
        vec![view.average(lag.iter().zip(torque).map(|(s, t)| s - t).collect())]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        memory(Rule::Lag, "load", "z - load")
    }
}
