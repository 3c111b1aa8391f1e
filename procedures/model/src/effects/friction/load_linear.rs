//! Load-dependent friction.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::effects::friction::teeth;
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct LoadLinear;

/// Gear teeth lock at this share of the load; a larger one indicates a wrong sign or unit of the load.
const MOST: f64 = 0.9;

static INFO: EffectInfo = EffectInfo {
    id: "load_linear",
    kind: Kind::Friction,
    title: "Load-dependent friction",
    sentence: "Tooth friction grows in proportion to the transmitted torque.",
    formula: "μ·|τ_link/N|·sign ω",
    source: "Bittencourt et al. 2010; Duclusaud et al. 2025, M3",
    looks: "a step at zero speed that grows with the load",
    parameters: &[parameter("mu", "1", 0.0, MOST), teeth::COS, teeth::SIN],
    needs: &["link_torque_nm"],
};

impl Effect for LoadLinear {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        teeth::forms(view, "mu")
    }

    fn formula_of(&self, form: &str) -> &str {
        match form {
            teeth::WITH_WEIGHT => "μ·|τ_link/N + g_c·cos θ_link + g_s·sin θ_link|·sign ω",
            teeth::ONLY_WEIGHT => "μ·|g_c·cos θ_link + g_s·sin θ_link|·sign ω",
            _ => INFO.formula,
        }
    }

    fn missing(&self, view: &View) -> Option<&'static str> {
        teeth::missing(view)
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        let load = teeth::transmitted_torque(shape, view);
        vec![load.iter().zip(view.get(Signal::Direction)).map(|(l, d)| l.abs() * d).collect()]
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        formula(format!("abs({}) * direction", teeth::torque(form.name)))
    }
}
