//! Hardening.

use crate::effect::{Columns, Effect, EffectInfo, Form, Shape, ShapeSearch, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Hardening;

static INFO: EffectInfo = EffectInfo {
    id: "hardening",
    kind: Kind::Stiffness,
    title: "Hardening",
    sentence: "Stiffness changes with the load, for example because more teeth engage.",
    formula: "κ·τ³, or φ_h·(√(1 + |τ|/τ_h) − 1)·sign τ, or φ_h·τ/(τ_hⁿ + |τ|ⁿ)^(1/n)",
    source: "Kircanski, Goldenberg 1997",
    looks: "a curve over torque, sign changes with the torque",
    parameters: &[
        parameter("kappa", "rad/Nm³", f64::NEG_INFINITY, f64::INFINITY),
        parameter("phi_h", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("tau_h", "Nm", 0.0, f64::INFINITY),
        parameter("n", "1", 1.0, 5.0),
    ],
    needs: &[],
};

impl Effect for Hardening {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let peak = view.peak(Signal::Load);
        let bend = |low: f64| Shape { name: "tau_h", min: low * peak, max: 2.0 * peak, search: ShapeSearch::Smooth };
        let loads = |low: f64| crate::effects::log_grid(low * peak, 2.0 * peak, 6);
        let sharpness = Shape { name: "n", min: 1.0, max: 5.0, search: ShapeSearch::Smooth };
        let of_root = loads(0.01).into_iter().map(|t| vec![t]).collect();
        // A curve that ends at lower loads is backlash.
        let of_start = loads(0.05).into_iter().flat_map(|t| [vec![t, 1.3], vec![t, 2.5]]).collect();
        vec![
            Form { name: "cubic", linear: vec!["kappa"], shape: Vec::new(), grid: vec![Vec::new()] },
            Form { name: "root", linear: vec!["phi_h"], shape: vec![bend(0.01)], grid: of_root },
            Form { name: "soft_start", linear: vec!["phi_h"], shape: vec![bend(0.05), sharpness], grid: of_start },
        ]
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        vec![match form {
            "cubic" => view.mean_of(Signal::Load, |t| t * t * t),
            "root" => view.mean_of(Signal::Load, |t| ((1.0 + t.abs() / shape[0]).sqrt() - 1.0) * t.signum()),
            _ => view
                .mean_of(Signal::Load, |t| t / (shape[0].powf(shape[1]) + t.abs().powf(shape[1])).powf(1.0 / shape[1])),
        }]
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        match form.name {
            "cubic" => formula("load * load * load"),
            "root" => formula("(sqrt(1 + abs(load) / tau_h) - 1) * sign(load)"),
            _ => formula("load / (tau_h^n + abs(load)^n)^(1 / n)"),
        }
    }
}
