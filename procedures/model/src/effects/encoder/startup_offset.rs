//! Start-up offset.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct StartupOffset;

/// One offset for each repeat after the first.
static NAMES: [&str; 12] =
    ["xi_1", "xi_2", "xi_3", "xi_4", "xi_5", "xi_6", "xi_7", "xi_8", "xi_9", "xi_10", "xi_11", "xi_12"];

static INFO: EffectInfo = EffectInfo {
    id: "startup_offset",
    kind: Kind::Encoder,
    title: "Start-up offset",
    sentence: "The encoder finds another zero at every power-up.",
    formula: "ξ_r for every repeat r after the first, up to twelve",
    source: "thesis on joint test benches, section 4.3 (start-up initialisation error)",
    looks: "another constant in every repeat",
    parameters: &[parameter("xi", "rad", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &["repeat"],
};

impl Effect for StartupOffset {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        match restarts(view).len() {
            0 => Vec::new(),
            n => vec![Form::linear(&NAMES[..n])],
        }
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        let is = |k: f64| view.map(Signal::Repeat, |r| f64::from(u8::from(r == k)));
        restarts(view).into_iter().map(is).collect()
    }
}

/// Numbers of the repeats after the first, as many as have a name.
fn restarts(view: &View) -> Vec<f64> {
    let mut numbers = view.get(Signal::Repeat).to_vec();
    numbers.sort_by(f64::total_cmp);
    numbers.dedup();
    numbers.into_iter().skip(1).take(NAMES.len()).collect()
}
