//! Fixed values, bounds and start values of parameters, on means at constant speed and sample by sample.

mod common;

use common::tables::{friction_in_steps, meta, scatter};
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{
    Fit, ModelError, ModelSpec, Options, Parameter, ParameterSetting, ParameterState, diagnose, fit,
};

const SPEEDS: [f64; 8] = [0.1, 0.2, 0.4, 0.8, 1.5, 3.0, 6.0, 12.0];

/// 30 mNm Coulomb, 2 mNm·s/rad viscous and 15 mNm Stribeck friction at 0.5 rad/s.
fn steps() -> RunTable {
    friction_in_steps(&SPEEDS, 2, 120, |now| {
        let speed = now.velocity.abs();
        let size = 0.03 + 0.002 * speed + 0.015 * (-(speed / 0.5).powi(2)).exp();
        now.velocity.signum() * size + 1e-4 * scatter(now.row, 5)
    })
}

/// A swing with 30 mNm Coulomb and 2 mNm·s/rad viscous friction.
fn swing() -> RunTable {
    let mut trace = Trace::new(["time_s", "motor_position_rad", "motor_current_a"].map(Channel::new).to_vec());
    for i in 0..3000 {
        let t = 0.004 * f64::from(i);
        let (position, velocity) = (5.0 * (2.0 * t).sin(), 10.0 * (2.0 * t).cos());
        let torque = 0.03 * velocity.signum() + 0.002 * velocity + 1e-3 * scatter(i as usize, 3);
        trace.push_row(&[t, position, torque / 0.08]);
    }
    RunTable::new(meta(Kind::Friction), trace).unwrap()
}

fn setting(effect: &str, name: &str) -> ParameterSetting {
    ParameterSetting { effect: effect.into(), name: name.into(), fixed: None, min: None, max: None, start: None }
}

fn fixed(effect: &str, name: &str, value: f64) -> ParameterSetting {
    ParameterSetting { fixed: Some(value), ..setting(effect, name) }
}

fn bounded(effect: &str, name: &str, min: Option<f64>, max: Option<f64>) -> ParameterSetting {
    ParameterSetting { min, max, ..setting(effect, name) }
}

fn fitted(run: &RunTable, effects: &str, settings: &[ParameterSetting]) -> Result<Fit, ModelError> {
    let spec = ModelSpec::parse(Kind::Friction, effects)?.with_settings(settings.to_vec())?;
    fit(run, &spec, &Options::default())
}

fn parameter<'f>(fit: &'f Fit, effect: &str, name: &str) -> &'f Parameter {
    fit.parameters.iter().find(|p| p.effect == effect && p.name == name).unwrap()
}

/// Minimises the squared error over `c_v` alone, for a known Coulomb friction.
fn viscous_at(run: &RunTable, effects: &str, coulomb: f64) -> f64 {
    let free = fitted(run, effects, &[]).unwrap();
    let near = parameter(&free, "viscous", "c_v").value;
    let rms = |c_v: f64| {
        let both = [fixed("coulomb", "tau_c", coulomb), fixed("viscous", "c_v", c_v)];
        fitted(run, effects, &both).unwrap().rms
    };
    // A parabola through three squared errors has its minimum at the least-squares solution.
    let step = 0.2 * near;
    let [a, b, c] = [near - step, near, near + step].map(|c_v| rms(c_v).powi(2));
    near + 0.5 * step * (a - c) / (a - 2.0 * b + c)
}

#[test]
fn a_fixed_coefficient_keeps_its_value_and_the_others_fit_around_it() {
    let run = steps();
    let fit = fitted(&run, "coulomb, viscous", &[fixed("coulomb", "tau_c", 0.04)]).unwrap();
    let coulomb = parameter(&fit, "coulomb", "tau_c");
    assert_eq!((coulomb.value, coulomb.ci95, coulomb.state), (0.04, [0.04, 0.04], ParameterState::Fixed));
    assert_eq!(fit.settings, [fixed("coulomb", "tau_c", 0.04)]);
    assert_eq!(fit.terms.iter().find(|t| t.effect == "coulomb").unwrap().linear, [0.04]);
    let viscous = parameter(&fit, "viscous", "c_v");
    let expected = viscous_at(&run, "coulomb, viscous", 0.04);
    assert!((viscous.value - expected).abs() < 1e-6 * expected.abs(), "{} {expected}", viscous.value);
    assert!(viscous.ci95[0] < viscous.value && viscous.value < viscous.ci95[1]);
    let free = fitted(&run, "coulomb, viscous", &[]).unwrap();
    assert!(fit.rms > free.rms && fit.validation_rms.is_finite());
}

#[test]
fn a_model_of_fixed_coefficients_only_is_evaluated() {
    for run in [steps(), swing()] {
        let all = [fixed("coulomb", "tau_c", 0.03), fixed("viscous", "c_v", 0.002)];
        let fit = fitted(&run, "coulomb, viscous", &all).unwrap();
        assert!(fit.parameters.iter().all(|p| p.state == ParameterState::Fixed), "{:?}", fit.parameters);
        assert!(fit.rms < 0.02 && fit.validation_rms >= fit.rms * 0.99, "{} {}", fit.rms, fit.validation_rms);
    }
}

#[test]
fn a_run_that_is_judged_sample_by_sample_follows_the_settings() {
    let run = swing();
    let fit = fitted(&run, "coulomb, viscous", &[fixed("coulomb", "tau_c", 0.028)]).unwrap();
    let coulomb = parameter(&fit, "coulomb", "tau_c");
    assert_eq!((coulomb.value, coulomb.state), (0.028, ParameterState::Fixed));
    // 2 mNm too little Coulomb friction are 2 mNm·(4/π) at the amplitude of 10 rad/s.
    let viscous = parameter(&fit, "viscous", "c_v").value;
    assert!(viscous > 2.05e-3 && viscous < 2.5e-3, "{viscous}");
    let bound = fitted(&run, "coulomb, viscous", &[bounded("coulomb", "tau_c", Some(0.035), None)]).unwrap();
    let coulomb = parameter(&bound, "coulomb", "tau_c");
    assert_eq!((coulomb.value, coulomb.state), (0.035, ParameterState::AtBound));
    assert!(coulomb.ci95[0] >= 0.035, "{coulomb:?}");
}

#[test]
fn wide_bounds_change_nothing_but_the_interval() {
    for run in [steps(), swing()] {
        let free = fitted(&run, "coulomb, viscous", &[]).unwrap();
        let wide = bounded("coulomb", "tau_c", Some(0.0), Some(1.0));
        let fit = fitted(&run, "coulomb, viscous", &[wide]).unwrap();
        assert_eq!((&fit.parameters, fit.rms), (&free.parameters, free.rms));
    }
}

#[test]
fn a_coefficient_at_its_bound_says_so_and_its_interval_does_not_cross_it() {
    let run = steps();
    let fit = fitted(&run, "coulomb, viscous", &[bounded("coulomb", "tau_c", Some(0.04), None)]).unwrap();
    let coulomb = parameter(&fit, "coulomb", "tau_c");
    assert_eq!((coulomb.value, coulomb.state), (0.04, ParameterState::AtBound));
    assert!(coulomb.ci95[0] >= 0.04 && coulomb.note.as_ref().unwrap().contains("bound of 40.0 mNm"), "{coulomb:?}");
    let same = fitted(&run, "coulomb, viscous", &[fixed("coulomb", "tau_c", 0.04)]).unwrap();
    assert_eq!(parameter(&fit, "viscous", "c_v").value, parameter(&same, "viscous", "c_v").value);
}

#[test]
fn a_bound_that_another_bound_makes_idle_is_released() {
    // Alone, the viscous friction violates its bound; with the Coulomb friction at its bound it does not.
    let run = steps();
    let tight = [bounded("coulomb", "tau_c", None, Some(0.02)), bounded("viscous", "c_v", Some(2.5e-3), Some(1.0))];
    let fit = fitted(&run, "coulomb, viscous", &tight).unwrap();
    let expected = viscous_at(&run, "coulomb, viscous", 0.02);
    assert!(expected > 2.5e-3, "{expected}");
    assert!((parameter(&fit, "viscous", "c_v").value - expected).abs() < 1e-6 * expected);
    assert_eq!(parameter(&fit, "coulomb", "tau_c").state, ParameterState::AtBound);
}

#[test]
fn nonlinear_parameters_are_fixed_bounded_and_started() {
    let (run, effects) = (steps(), "coulomb, viscous, stribeck");
    let free = fitted(&run, effects, &[]).unwrap();
    let speed = parameter(&free, "stribeck", "omega_s").value;
    assert!((speed - 0.5).abs() < 0.05, "{speed}");
    let held = fitted(&run, effects, &[fixed("stribeck", "omega_s", 0.8)]).unwrap();
    let fixed_speed = parameter(&held, "stribeck", "omega_s");
    assert_eq!((fixed_speed.value, fixed_speed.ci95), (0.8, [0.8, 0.8]));
    assert!(fixed_speed.state == ParameterState::Fixed && held.rms > free.rms);
    let low = fitted(&run, effects, &[bounded("stribeck", "omega_s", None, Some(0.3))]).unwrap();
    let bound = parameter(&low, "stribeck", "omega_s");
    assert!((bound.value - 0.3).abs() < 1e-6 && bound.state == ParameterState::AtBound, "{bound:?}");
    assert!(bound.ci95[1] <= 0.3 + 1e-9, "{bound:?}");
    let start = ParameterSetting { start: Some(0.7), ..setting("stribeck", "omega_s") };
    let started = fitted(&run, effects, &[start]).unwrap();
    let found = parameter(&started, "stribeck", "omega_s");
    assert!((found.value - speed).abs() < 0.02 * speed && found.state == ParameterState::Ok, "{found:?}");
}

#[test]
fn a_fixed_coefficient_with_a_nonlinear_factor_moves_the_factor() {
    let (run, effects) = (steps(), "coulomb, viscous, stribeck");
    let fit = fitted(&run, effects, &[fixed("stribeck", "tau_s", 0.015)]).unwrap();
    assert_eq!(parameter(&fit, "stribeck", "tau_s").state, ParameterState::Fixed);
    let speed = parameter(&fit, "stribeck", "omega_s");
    assert!(
        (speed.value - 0.5).abs() < 0.05 && speed.ci95[0] < speed.value && speed.ci95[1] > speed.value,
        "{speed:?}"
    );
    let names = |fit: &Fit| fit.parameters.iter().map(|p| p.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&fit), names(&fitted(&run, effects, &[]).unwrap()));
}

#[test]
fn settings_that_no_fit_can_follow_are_refused_with_the_reason() {
    let run = steps();
    let start = |effect: &str, name: &str, value| ParameterSetting { start: Some(value), ..setting(effect, name) };
    for (settings, text) in [
        (vec![fixed("gravity", "a", 1.0)], "the model does not contain the effect"),
        (vec![fixed("coulomb", "tau", 1.0)], "no such parameter; it has tau_c"),
        (vec![setting("coulomb", "tau_c")], "nothing is set"),
        (vec![fixed("coulomb", "tau_c", f64::NAN)], "not a finite number"),
        (vec![bounded("coulomb", "tau_c", Some(2.0), Some(1.0))], "min 2 is larger than max 1"),
        (
            vec![ParameterSetting { fixed: Some(3.0), ..bounded("coulomb", "tau_c", Some(0.0), Some(1.0)) }],
            "fixed 3 is outside its bounds (0 to 1)",
        ),
        (vec![fixed("coulomb", "tau_c", -1.0)], "outside its physical range"),
        (vec![start("coulomb", "tau_c", 0.1)], "a start value has no influence"),
        (vec![fixed("coulomb", "tau_c", 0.1), fixed("coulomb", "tau_c", 0.2)], "set twice"),
    ] {
        let fault = fitted(&run, "coulomb, viscous", &settings).unwrap_err().to_string();
        assert!(fault.contains(text), "{fault}");
    }
    let set = ModelSpec::parse(Kind::Friction, "coulomb").unwrap().with_settings(vec![fixed("coulomb", "tau_c", 0.03)]);
    assert_eq!(diagnose(&run, &set.unwrap(), &Options::default()).unwrap_err(), ModelError::NotDiagnosed);
}
