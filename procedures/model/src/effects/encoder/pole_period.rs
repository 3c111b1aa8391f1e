//! Pole period error.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, waves};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct PolePeriod;

/// Name of the form without the second harmonic.
const FUNDAMENTAL: &str = "fundamental";

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
    /// lower order that does not exist. A single wave of unknown pole pairs is their fundamental: it could also be the
    /// second harmonic of half as many, whose own fundamental would be absent.
    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let both = |orders| crate::effects::whole_orders(orders, f64::INFINITY, "pole_pairs", &["a", "b", "c", "d"]);
        match view.constants.pole_pairs {
            Some(1) => return Vec::new(),
            Some(p) => return both(p..=p),
            None => {}
        }
        let one = crate::effects::whole_orders(16..=128, f64::INFINITY, "pole_pairs", &["a", "b"]);
        one.into_iter().map(|form| Form { name: FUNDAMENTAL, ..form }).chain(both(16..=128)).collect()
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        let mut columns: Columns = view.harmonic(Signal::Position, shape[0]).into();
        if form != FUNDAMENTAL {
            columns.extend(view.harmonic(Signal::Position, 2.0 * shape[0]));
        }
        columns
    }

    fn traits(&self) -> Traits {
        let unseen = Some("with one pole pair it is the sum of harmonic_1 and harmonic_2, which represent it");
        Traits { unseen, ..Traits::default() }
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        let orders = ["pole_pairs", "2 * pole_pairs"];
        Ok(waves("position", "", if form.name == FUNDAMENTAL { &orders[..1] } else { &orders }))
    }
}
