//! Velocity dependence.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::effects::brake::scaled;
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::thresholds::SEVERAL_SPEEDS;
use crate::view::View;
use jointbench_instrument::Kind;

pub struct VelocityDependence;

static INFO: EffectInfo = EffectInfo {
    id: "velocity_dependence",
    kind: Kind::Brake,
    title: "Velocity dependence",
    sentence: "The braking torque changes with speed because of eddy currents and windage.",
    formula: "c_v·|ω|, or c_v·i·|ω|, or c_v·(|ω| − ω_0)·τ with the torque τ that current and history explain at ω_0",
    source: "Data sheets of hysteresis brakes (eddy currents)",
    looks: "a line over speed; needs at least two speeds",
    parameters: &[
        parameter("c_v", "Nm·s/rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("c_v_i", "Nm·s/(rad·A)", f64::NEG_INFINITY, f64::INFINITY),
        parameter("c_v_tau", "s/rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("omega_0", "rad/s", 0.0, f64::INFINITY),
    ],
    needs: &["velocity_rad_s"],
};

impl Effect for VelocityDependence {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        // At a single speed the effect is identical to the torque itself.
        let several = crate::effects::speed_range(view).is_some_and(|(slow, fast)| fast > SEVERAL_SPEEDS * slow);
        if !several {
            return Vec::new();
        }
        let form = |name, linear| Form { name, ..Form::linear(linear) };
        let usual = scaled::usual(view, Signal::Velocity, f64::abs);
        vec![form("plain", &["c_v"]), form("excited", &["c_v_i"]), scaled::form("c_v_tau", "omega_0", usual)]
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        vec![match form {
            "plain" => view.map(Signal::Velocity, f64::abs),
            "excited" => view.map2(Signal::Velocity, Signal::Current, |w, i| w.abs() * i),
            _ => view.map2(Signal::Velocity, Signal::Drive, |w, t| (w.abs() - shape[0]) * t),
        }]
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        match form.name {
            "plain" => formula("abs(velocity)"),
            "excited" => formula("abs(velocity) * current"),
            _ => Err(scaled::NOT_IN_A_CONTROLLER),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Signals;

    #[test]
    fn two_speeds_that_are_a_third_apart_are_two() {
        let is_seen = |fast: f64| {
            let velocity: Vec<f64> = (0..400).map(|i| if i < 200 { 9.8 } else { fast }).collect();
            let mut signals = Signals::new(velocity.len());
            signals.set(Signal::Velocity, velocity);
            !VelocityDependence.forms(&View::new(signals.clone(), signals, Vec::new(), vec![0], 0.01)).is_empty()
        };
        assert_eq!([10.5, 12.8, 30.0].map(is_seen), [false, true, true]);
    }
}
