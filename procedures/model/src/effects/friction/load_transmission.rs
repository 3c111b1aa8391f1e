//! Load through the gear.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits};
use crate::signal::Signal;
use crate::view::View;
use jointbench_instrument::Kind;

pub struct LoadTransmission;

pub(crate) const ID: &str = "load_transmission";

static INFO: EffectInfo = EffectInfo {
    id: ID,
    kind: Kind::Friction,
    title: "Load through the gear",
    sentence: "Torque that the joint delivers to the load, divided by the gear ratio.",
    formula: "τ_link/N",
    source: "Power balance of an ideal gear; Bittencourt et al. 2010",
    looks: "proportional to the link torque",
    parameters: &[],
    needs: &["link_torque_nm"],
};

impl Effect for LoadTransmission {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["one"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.get(Signal::Load).to_vec()]
    }

    fn traits(&self) -> Traits {
        Traits { is_offset: true, ..Traits::default() }
    }
}
