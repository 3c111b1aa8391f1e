//! Hardening.

use crate::effect::{Columns, Effect, EffectInfo, Form, Search, Shape, parameter};
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct Hardening;

static INFO: EffectInfo = EffectInfo {
    id: "hardening",
    kind: Kind::Stiffness,
    title: "Hardening",
    sentence: "The joint gets stiffer or softer the more it is loaded, as more teeth come to bear.",
    formula: "κ·τ³, or φ_h·(√(1 + |τ|/τ_h) − 1)·sgn τ, or φ_h·tanh(τ/τ_h)",
    source: "thesis on joint test benches, joint B softer at low torque; Kircanski and Goldenberg 1997",
    looks: "a curve over torque, odd",
    parameters: &[
        parameter("kappa", "rad/Nm³", f64::NEG_INFINITY, f64::INFINITY),
        parameter("phi_h", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("tau_h", "Nm", 0.0, f64::INFINITY),
    ],
    needs: &[],
};

impl Effect for Hardening {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let peak = view.peak(Signal::Load);
        let shape = vec![Shape { name: "tau_h", min: 0.01 * peak, max: 2.0 * peak, search: Search::Smooth }];
        let grid: Vec<Vec<f64>> =
            crate::effects::log_grid(0.01 * peak, 2.0 * peak, 6).into_iter().map(|t| vec![t]).collect();
        let curved = |name| Form { name, linear: vec!["phi_h"], shape: shape.clone(), grid: grid.clone() };
        vec![
            Form { name: "cubic", linear: vec!["kappa"], shape: Vec::new(), grid: vec![Vec::new()] },
            curved("root"),
            curved("tanh"),
        ]
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        vec![match form {
            "cubic" => view.map(Signal::Load, |t| t * t * t),
            "root" => view.map(Signal::Load, |t| ((1.0 + t.abs() / shape[0]).sqrt() - 1.0) * t.signum()),
            _ => view.map(Signal::Load, |t| (t / shape[0]).tanh()),
        }]
    }
}
