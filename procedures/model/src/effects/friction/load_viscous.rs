//! Load-dependent viscous friction.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct LoadViscous;

static INFO: EffectInfo = EffectInfo {
    id: "load_viscous",
    kind: Kind::Friction,
    title: "Load-dependent viscous friction",
    sentence: "Under load the drag grows more steeply with speed.",
    formula: "c_l·|τ_link/N|·ω",
    source: "Bittencourt et al. 2010",
    looks: "a line over speed whose slope grows with the load",
    parameters: &[parameter("c_l", "s/rad", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &["link_torque_nm"],
};

impl Effect for LoadViscous {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        if view.bears_load() { vec![Form::linear(&["c_l"])] } else { Vec::new() }
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.map2(Signal::Load, Signal::Velocity, |l, w| l.abs() * w)]
    }
}
