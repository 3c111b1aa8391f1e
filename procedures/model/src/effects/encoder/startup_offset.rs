//! Start-up offset.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct StartupOffset;

static INFO: EffectInfo = EffectInfo {
    id: "startup_offset",
    kind: Kind::Encoder,
    title: "Start-up offset",
    sentence: "The encoder finds another zero at every power-up.",
    formula: "ξ_r for every repeat r after the first",
    source: "thesis on joint test benches, section 4.3 (start-up initialisation error)",
    looks: "another constant in every repeat",
    parameters: &[
        parameter("xi_1", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("xi_2", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("xi_3", "rad", f64::NEG_INFINITY, f64::INFINITY),
    ],
    needs: &["repeat"],
};

impl Effect for StartupOffset {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let most = view.get(Signal::Repeat).iter().fold(0.0f64, |m, r| m.max(*r));
        match most as usize {
            0 => Vec::new(),
            1 => vec![Form::linear(&["xi_1"])],
            2 => vec![Form::linear(&["xi_1", "xi_2"])],
            _ => vec![Form::linear(&["xi_1", "xi_2", "xi_3"])],
        }
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        let most = view.get(Signal::Repeat).iter().fold(0.0f64, |m, r| m.max(*r)).min(3.0);
        (1..=most as usize).map(|k| view.map(Signal::Repeat, |r| if r as usize == k { 1.0 } else { 0.0 })).collect()
    }
}
