//! Gravity.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::signal::Signal;
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Gravity;

static INFO: EffectInfo = EffectInfo {
    id: "gravity",
    kind: Kind::Friction,
    title: "Gravity",
    sentence: "A weight that is off the axis pulls the joint once per link turn.",
    formula: "g_c·cos θ_link + g_s·sin θ_link",
    source: "Puma chapter, removal of gravity by pose",
    looks: "one wave per link turn, the same in both directions",
    parameters: &[
        parameter("g_c", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("g_s", "Nm", f64::NEG_INFINITY, f64::INFINITY),
    ],
    needs: &["link_position_rad"],
};

impl Effect for Gravity {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        if view.constants.slides { Vec::new() } else { vec![Form::linear(&["g_c", "g_s"])] }
    }

    fn is_exact(&self) -> bool {
        true
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        view.harmonic(Signal::Link, 1.0).into()
    }
}
