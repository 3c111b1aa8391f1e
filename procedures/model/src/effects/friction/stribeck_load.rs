//! Stribeck effect that grows with the load.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct StribeckLoad;

static INFO: EffectInfo = EffectInfo {
    id: "stribeck_load",
    kind: Kind::Friction,
    title: "Load-dependent Stribeck effect",
    sentence: "The rise of friction at low speed grows with the transmitted torque.",
    formula: "μ_s·|τ_link/N|·exp(−(|ω|/ω_s)^δ)·sign ω",
    source: "Duclusaud et al. 2025, M4",
    looks: "a rise at the lowest speeds, only under load",
    parameters: &[
        parameter("mu_s", "1", 0.0, f64::INFINITY),
        parameter("omega_s", "rad/s", 0.0, f64::INFINITY),
        parameter("delta", "1", 0.5, 3.0),
    ],
    needs: &["link_torque_nm"],
};

impl Effect for StribeckLoad {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let Some((shape, grid)) = crate::effects::friction::stribeck::search(view).filter(|_| view.bears_load()) else {
            return Vec::new();
        };
        vec![Form { name: "exponential", linear: vec!["mu_s"], shape, grid }]
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        let fading = crate::effects::friction::stribeck::fading(view, shape);
        vec![fading.iter().zip(view.get(Signal::Load)).map(|(f, l)| f * l.abs()).collect()]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("exp(-(abs(velocity) / omega_s) ^ delta) * direction * abs(load)")
    }

    fn traits(&self) -> Traits {
        Traits { exponent_parameter: Some("delta"), ..Traits::default() }
    }
}
