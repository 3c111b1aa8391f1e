//! Direction hysteresis.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct DirectionHysteresis;

static INFO: EffectInfo = EffectInfo {
    id: "direction_hysteresis",
    kind: Kind::Encoder,
    title: "Direction hysteresis",
    sentence: "The reading depends on the direction of approach because of play in the coupling or magnetic \
               hysteresis.",
    formula: "h·sign ω",
    source: "ISO 230-2:2014, reversal error",
    looks: "a constant that changes sign with the direction",
    parameters: &[parameter("h", "rad", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &[],
};

impl Effect for DirectionHysteresis {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["h"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.get(Signal::Direction).to_vec()]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("direction")
    }
}
