//! Pole period error.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::signal::Signal;
use crate::view::View;
use jointbench_instrument::Kind;

pub struct PolePeriod;

static INFO: EffectInfo = EffectInfo {
    id: "pole_period",
    kind: Kind::Encoder,
    title: "Pole period error",
    sentence: "Within a pole pair the angle is interpolated from sine and cosine. Unequal offset, gain or phase causes \
               one and two periods per pole pair.",
    formula: "a·cos pθ + b·sin pθ + c·cos 2pθ + d·sin 2pθ, p pole pairs",
    source: "Heydemann 1981",
    looks: "p and 2p periods per turn",
    parameters: &[
        parameter("a", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("b", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("c", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("d", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("pole_pairs", "1/turn", 1.0, 128.0),
    ],
    needs: &[],
};

impl Effect for PolePeriod {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    /// All orders of known pole pairs are included, even beyond the sampling limit: an omitted wave would alias to a
    /// lower order that does not exist.
    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let orders = match view.constants.pole_pairs {
            Some(p) => p..=p,
            None => 16..=128,
        };
        crate::effects::whole_orders(orders, f64::INFINITY, "pole_pairs", &["a", "b", "c", "d"])
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        let [a, b] = view.harmonic(Signal::Position, shape[0]);
        let [c, d] = view.harmonic(Signal::Position, 2.0 * shape[0]);
        vec![a, b, c, d]
    }
}
