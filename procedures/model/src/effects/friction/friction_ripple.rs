//! Friction ripple.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, orders, waves};
use crate::thresholds::WHOLE_TURN;
use crate::view::View;
use jointbench_instrument::Kind;

pub struct FrictionRipple;

static INFO: EffectInfo = EffectInfo {
    id: "friction_ripple",
    kind: Kind::Friction,
    title: "Friction ripple",
    sentence: "Run-out of bearings or teeth: friction varies periodically with the link angle.",
    formula: "(a·cos(h·θ_link) + b·sin(h·θ_link))·sign ω, or with (a + a_v·|ω|) and (b + b_v·|ω|), h estimated",
    source: "Armstrong-Hélouvry 1991, position-dependent friction",
    looks: "periodic over the link angle, sign changes with the direction",
    parameters: &[
        parameter("a", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("b", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("a_v", "Nm·s/rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("b_v", "Nm·s/rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("harmonic", "1/turn", 1.0, 60.0),
    ],
    needs: &["link_position_rad"],
};

impl Effect for FrictionRipple {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        // With nuisance columns for reversals and speed, a wave of nearly one period is sufficient.
        if view.constants.followed_hz.is_some() {
            let first = (WHOLE_TURN / view.turns(Signal::Link)).ceil().clamp(1.0, 25.0) as u32;
            return crate::effects::harmonic_form(view, Signal::Link, first..=24);
        }
        let mut forms = crate::effects::repeated_harmonic_form(view, Signal::Link, 1..=60);
        let with_speed =
            forms.iter().map(|f| Form { name: "with_speed", linear: vec!["a", "b", "a_v", "b_v"], ..f.clone() });
        forms.extend(with_speed.collect::<Vec<_>>());
        forms
    }

    fn traits(&self) -> Traits {
        Traits { wave: Some(Signal::Link), ..Traits::default() }
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        let [cos, sin] = view.harmonic(Signal::Link, shape[0]);
        let times = |wave: &[f64], signal| wave.iter().zip(view.get(signal)).map(|(w, s)| w * s).collect::<Vec<f64>>();
        let mut columns = vec![times(&cos, Signal::Direction), times(&sin, Signal::Direction)];
        if form == "with_speed" {
            columns.extend([times(&cos, Signal::Velocity), times(&sin, Signal::Velocity)]);
        }
        columns
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        let mut columns = waves("link_position", " * direction", &orders(form));
        if form.name == "with_speed" {
            columns.extend(waves("link_position", " * velocity", &orders(form)));
        }
        Ok(columns)
    }

    fn same_as(&self, view: &View) -> Option<&'static str> {
        (view.is_one_directional() && view.is_direct()).then_some("cogging")
    }
}
