//! Friction ripple.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct FrictionRipple;

static INFO: EffectInfo = EffectInfo {
    id: "friction_ripple",
    kind: Kind::Friction,
    title: "Friction ripple",
    sentence: "Bearings or teeth that are not quite round rub harder at some link angles than at others.",
    formula: "(a·cos(h·θ_link) + b·sin(h·θ_link))·sgn ω, h found",
    source: "contract section 2; Armstrong-Hélouvry 1991, position-dependent friction",
    looks: "waves over the link angle that change sign with the direction",
    parameters: &[
        parameter("a", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("b", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("harmonic", "1/turn", 1.0, 60.0),
    ],
    needs: &["link_position_rad"],
};

impl Effect for FrictionRipple {
    fn info(&self) -> &'static EffectInfo {
        &INFO
    }

    fn forms(&self, view: &View) -> Vec<Form> {
        crate::effects::harmonic_form(view, Signal::Link, 1..=60)
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        let direction = view.get(Signal::Direction);
        let mut columns = view.harmonic(Signal::Link, shape[0]);
        for column in &mut columns {
            column.iter_mut().zip(direction).for_each(|(c, d)| *c *= d);
        }
        columns.into()
    }
}
