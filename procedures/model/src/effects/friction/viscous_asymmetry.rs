//! Viscous asymmetry.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct ViscousAsymmetry;

static INFO: EffectInfo = EffectInfo {
    id: "viscous_asymmetry",
    kind: Kind::Friction,
    title: "Viscous asymmetry",
    sentence: "Viscous friction differs between the directions.",
    formula: "c_a·|ω|, that is c⁺ = c_v + c_a and c⁻ = c_v − c_a",
    source: "Janot, Gautier, Brunot 2019, section 5",
    looks: "a V over speed: equal sign in both directions",
    parameters: &[parameter("c_a", "Nm·s/rad", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &[],
};

impl Effect for ViscousAsymmetry {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["c_a"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.map(Signal::Velocity, f64::abs)]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("abs(velocity)")
    }

    fn same_as(&self, view: &View) -> Option<&'static str> {
        view.is_one_directional().then_some("viscous")
    }

    fn traits(&self) -> Traits {
        Traits { corrects: Some("viscous"), ..Traits::default() }
    }
}
