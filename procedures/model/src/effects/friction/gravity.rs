//! Gravity.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, waves};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Gravity;

static INFO: EffectInfo = EffectInfo {
    id: "gravity",
    kind: Kind::Friction,
    title: "Gravity",
    sentence: "An eccentric mass: the torque has one period per link turn.",
    formula: "g_c·cos θ_link + g_s·sin θ_link",
    source: "Armstrong, Khatib, Burdick 1986",
    looks: "one period per link turn, equal in both directions",
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

    fn traits(&self) -> Traits {
        Traits { is_exact: true, ..Traits::default() }
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        view.harmonic(Signal::Link, 1.0).into()
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        Ok(waves("link_position", "", &["1"]))
    }
}
