//! Quadratic load friction.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::effects::friction::teeth;
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct LoadQuadratic;

static INFO: EffectInfo = EffectInfo {
    id: "load_quadratic",
    kind: Kind::Friction,
    title: "Quadratic load friction",
    sentence: "Friction grows with the square of the load, for example because the gear deforms under torque.",
    formula: "μ_2·(τ_link/N)²·sign ω",
    source: "Duclusaud et al. 2025, M6",
    looks: "a step at zero speed that grows with the square of the load",
    parameters: &[parameter("mu_2", "1/Nm", 0.0, f64::INFINITY), teeth::COS, teeth::SIN],
    needs: &["link_torque_nm"],
};

impl Effect for LoadQuadratic {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        teeth::forms(view, "mu_2")
    }

    fn formula_of(&self, form: &str) -> &str {
        match form {
            teeth::WITH_WEIGHT => "μ_2·(τ_link/N + g_c·cos θ_link + g_s·sin θ_link)²·sign ω",
            teeth::ONLY_WEIGHT => "μ_2·(g_c·cos θ_link + g_s·sin θ_link)²·sign ω",
            _ => INFO.formula,
        }
    }

    fn missing(&self, view: &View) -> Option<&'static str> {
        teeth::missing(view)
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        let load = teeth::transmitted_torque(shape, view);
        vec![load.iter().zip(view.get(Signal::Direction)).map(|(l, d)| l * l * d).collect()]
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        formula(format!("{0} * {0} * direction", teeth::torque(form.name)))
    }
}
