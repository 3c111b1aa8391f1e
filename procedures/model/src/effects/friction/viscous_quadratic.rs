//! Quadratic drag.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct ViscousQuadratic;

static INFO: EffectInfo = EffectInfo {
    id: "viscous_quadratic",
    kind: Kind::Friction,
    title: "Quadratic drag",
    sentence: "Drag has a part proportional to the square of speed, as in churning oil or windage. With a negative \
               c_2, drag grows less than in proportion to speed; the torque of c_2a has one sign in both.",
    formula: "c_2·ω·|ω|, or c_2a·ω² if it differs between the directions",
    source: "Armstrong-Hélouvry, Dupont, Canudas de Wit 1994",
    looks: "a curve over speed, sign changes with the direction, steepest at top speed",
    parameters: &[
        parameter("c_2", "Nm·s²/rad²", f64::NEG_INFINITY, f64::INFINITY),
        parameter("c_2a", "Nm·s²/rad²", f64::NEG_INFINITY, f64::INFINITY),
    ],
    needs: &[],
};

impl Effect for ViscousQuadratic {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    /// In one direction both forms are equal up to the sign.
    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let even = Form { name: "one_sided", ..Form::linear(&["c_2a"]) };
        if view.is_one_directional() { vec![Form::linear(&["c_2"])] } else { vec![Form::linear(&["c_2"]), even] }
    }

    fn columns(&self, form: &str, _: &[f64], view: &View) -> Columns {
        vec![match form {
            "one_sided" => view.map(Signal::Velocity, |w| w * w),
            _ => view.map(Signal::Velocity, |w| w * w.abs()),
        }]
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        match form.name {
            "one_sided" => formula("velocity * velocity"),
            _ => formula("velocity * abs(velocity)"),
        }
    }
}
