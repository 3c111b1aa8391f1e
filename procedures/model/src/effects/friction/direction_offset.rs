//! Direction offset.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct DirectionOffset;

pub(crate) const ID: &str = "direction_offset";

static INFO: EffectInfo = EffectInfo {
    id: ID,
    kind: Kind::Friction,
    title: "Direction offset",
    sentence: "Coulomb friction differs between the directions. In motion this is equivalent to a constant torque, \
               such as an offset of the current sensor.",
    formula: "τ_0, that is τ_c⁺ = τ_c + τ_0 and τ_c⁻ = τ_c − τ_0",
    source: "Armstrong-Hélouvry 1991; Janot, Gautier, Brunot 2019, eq. 2",
    looks: "the same constant at all speeds and in both directions",
    parameters: &[parameter("tau_0", "Nm", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &[],
};

impl Effect for DirectionOffset {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["tau_0"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![vec![1.0; view.len()]]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("1")
    }

    fn same_as(&self, view: &View) -> Option<&'static str> {
        view.is_one_directional().then_some("coulomb")
    }
}
