//! Backlash.

use crate::effect::{Columns, Effect, EffectInfo, Form, Shape, ShapeSearch, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Backlash;

static INFO: EffectInfo = EffectInfo {
    id: "backlash",
    kind: Kind::Stiffness,
    title: "Backlash",
    sentence: "Clearance between the tooth flanks, crossed when the torque changes sign.",
    formula: "β·tanh(τ/τ_b)",
    source: "Nordin, Gutman 2002",
    looks: "a step at zero torque",
    parameters: &[parameter("beta", "rad", 0.0, f64::INFINITY), parameter("tau_b", "Nm", 0.0, f64::INFINITY)],
    needs: &[],
};

impl Effect for Backlash {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let peak = view.peak(Signal::Load);
        let shape = vec![Shape { name: "tau_b", min: 3e-3 * peak, max: 0.05 * peak, search: ShapeSearch::Smooth }];
        let grid = crate::effects::log_grid(3e-3 * peak, 0.05 * peak, 3).into_iter().map(|t| vec![t]).collect();
        vec![Form { name: "dead_zone", linear: vec!["beta"], shape, grid }]
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        vec![view.mean_of(Signal::Load, |t| (t / shape[0]).tanh())]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("tanh(load / tau_b)")
    }
}
