//! Slip.

use crate::effect::{Columns, Effect, EffectInfo, Form, Shape, ShapeSearch, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Slip;

static INFO: EffectInfo = EffectInfo {
    id: "slip",
    kind: Kind::Encoder,
    title: "Slip",
    sentence: "The ring or the coupling slipped on the shaft: the difference changes in one step.",
    formula: "s from the time t_s on",
    source: "Hansen 2000 (estimation of the time of a change)",
    looks: "a step in time",
    parameters: &[parameter("s", "rad", f64::NEG_INFINITY, f64::INFINITY), parameter("t_s", "s", 0.0, f64::INFINITY)],
    needs: &[],
};

impl Effect for Slip {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let time = view.get(Signal::Time);
        let (Some(first), Some(last)) = (time.first(), time.last()) else { return Vec::new() };
        let (low, high) = (first + 0.02 * (last - first), last - 0.02 * (last - first));
        let grid = (0..=160).map(|i| vec![low + (high - low) * f64::from(i) / 160.0]).collect();
        let shape = vec![Shape { name: "t_s", min: low, max: high, search: ShapeSearch::Jump }];
        vec![Form { name: "step", linear: vec!["s"], shape, grid }]
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        vec![view.map(Signal::Time, |t| if t >= shape[0] { 1.0 } else { 0.0 })]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("max(sign(time - t_s), 0)")
    }
}
