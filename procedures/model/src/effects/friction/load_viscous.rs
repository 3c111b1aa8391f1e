//! Load-dependent viscous friction.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::effects::friction::teeth;
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct LoadViscous;

static INFO: EffectInfo = EffectInfo {
    id: "load_viscous",
    kind: Kind::Friction,
    title: "Load-dependent viscous friction",
    sentence: "Viscous friction changes with the load.",
    formula: "c_l·|τ_link/N|·ω",
    source: "Bittencourt et al. 2010",
    looks: "a line over speed whose slope grows with the load",
    parameters: &[parameter("c_l", "s/rad", f64::NEG_INFINITY, f64::INFINITY), teeth::COS, teeth::SIN],
    needs: &["link_torque_nm"],
};

impl Effect for LoadViscous {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        teeth::forms(view, "c_l")
    }

    fn formula_of(&self, form: &str) -> &str {
        match form {
            teeth::WITH_WEIGHT => "c_l·|τ_link/N + g_c·cos θ_link + g_s·sin θ_link|·ω",
            teeth::ONLY_WEIGHT => "c_l·|g_c·cos θ_link + g_s·sin θ_link|·ω",
            _ => INFO.formula,
        }
    }

    fn missing(&self, view: &View) -> Option<&'static str> {
        teeth::missing(view)
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        let load = teeth::transmitted_torque(shape, view);
        vec![load.iter().zip(view.get(Signal::Velocity)).map(|(l, w)| l.abs() * w).collect()]
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        formula(format!("abs({}) * velocity", teeth::torque(form.name)))
    }
}
