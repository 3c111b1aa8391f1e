//! Load-dependent friction.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct LoadLinear;

/// Teeth that take nearly all of the load away lock: what seems larger is a load of another sign or unit.
const MOST: f64 = 0.9;

static INFO: EffectInfo = EffectInfo {
    id: "load_linear",
    kind: Kind::Friction,
    title: "Load-dependent friction",
    sentence: "The teeth rub harder under load: friction grows in proportion to the transmitted torque.",
    formula: "μ·|τ_link/N|·sgn ω",
    source: "thesis on joint test benches, eq. 2.6; Duclusaud et al. 2025, M3",
    looks: "a step at zero speed that grows with the load",
    parameters: &[parameter("mu", "1", -MOST, MOST)],
    needs: &["link_torque_nm"],
};

impl Effect for LoadLinear {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        if view.bears_load() { vec![Form::linear(&["mu"])] } else { Vec::new() }
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.map2(Signal::Load, Signal::Direction, |l, d| l.abs() * d)]
    }
}
