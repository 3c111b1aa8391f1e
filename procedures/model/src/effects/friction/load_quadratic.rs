//! Quadratic load friction.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct LoadQuadratic;

static INFO: EffectInfo = EffectInfo {
    id: "load_quadratic",
    kind: Kind::Friction,
    title: "Quadratic load friction",
    sentence: "Friction grows faster than the load, as when a gear deforms under torque.",
    formula: "μ_2·(τ_link/N)²·sgn ω",
    source: "thesis on joint test benches, eq. 2.6; Duclusaud et al. 2025, M6",
    looks: "a step at zero speed that grows with the square of the load",
    parameters: &[parameter("mu_2", "1/Nm", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &["link_torque_nm"],
};

impl Effect for LoadQuadratic {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        if view.bears_load() { vec![Form::linear(&["mu_2"])] } else { Vec::new() }
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.map2(Signal::Load, Signal::Direction, |l, d| l * l * d)]
    }
}
