//! On one sine the jerk is proportional to the velocity, and the snap to the acceleration, with opposite signs.

use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, UserEffect, diagnose, evaluate, fit};
use std::f64::consts::TAU;

const KM: f64 = 0.064;

/// Inertia, dry and viscous friction on one sine.
fn one_sine(baseline: &[&str]) -> RunTable {
    let (rate_hz, hz, size) = (500.0, 0.25, 60.0);
    let mut noise = 3u64;
    let mut scatter = || {
        noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (noise >> 33) as f64 / f64::from(1u32 << 30) - 1.0
    };
    let time_s: Vec<f64> = (0..20_000).map(|i| f64::from(i) / rate_hz).collect();
    let turn = |t: &f64| TAU * hz * t;
    // An encoder of 14 bits.
    let step = TAU / 16_384.0;
    let position = time_s.iter().map(|t| (size * turn(t).sin() / step).round() * step).collect();
    let torque = |t: &f64| {
        let velocity = TAU * hz * size * turn(t).cos();
        let acceleration = -(TAU * hz).powi(2) * size * turn(t).sin();
        0.02 * velocity.signum() + 2e-4 * velocity + 2e-5 * acceleration
    };
    let current = time_s.iter().map(|t| (torque(t) + 3e-4 * scatter()) / KM).collect();
    let names = ["time_s", "motor_position_rad", "motor_current_a"].map(Channel::new).to_vec();
    let baseline = baseline.iter().map(|id| id.to_string()).collect();
    let meta = Meta { kind: Some(Kind::Friction), baseline, torque_constant_nm_per_a: Some(KM), ..Meta::default() };
    RunTable::new(meta, Trace::from_columns(names, vec![time_s.clone(), position, current])).unwrap()
}

#[test]
fn what_an_effect_says_is_no_error_of_a_formula() {
    let run = one_sine(&["inertia", "coulomb", "viscous"]);
    let found = fit(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
    for (name, truth) in [("j", 2e-5), ("tau_c", 0.02), ("c_v", 2e-4)] {
        let p = found.parameters.iter().find(|p| p.name == name).unwrap();
        assert!((p.value / truth - 1.0).abs() < 0.03, "{p:?} instead of {truth}");
    }
}

#[test]
fn a_missing_effect_is_found_that_form_error_imitates() {
    for (has, missing) in [(["coulomb", "viscous"], "inertia"), (["inertia", "coulomb"], "viscous")] {
        let run = one_sine(&has);
        let found = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
        let named: Vec<&str> = found.suggestions.iter().map(|s| s.effect.as_str()).collect();
        assert_eq!(named.first(), Some(&missing), "{named:?}");
    }
}

#[test]
fn an_effect_of_the_library_comes_before_a_formula_of_a_user() {
    let run = one_sine(&["inertia", "coulomb"]);
    let text = "drag: tau = a * velocity + b * velocity * abs(velocity); a [Nm*s/rad]; b [Nm*s^2/rad^2]";
    let own = vec![UserEffect::inline(Kind::Friction, text).unwrap()];
    let spec = ModelSpec::with_user_effects(Kind::Friction, run.meta().baseline.iter(), own).unwrap();
    let found = diagnose(&run, &spec, &Options::default()).unwrap();
    assert_eq!(found.suggestions.first().map(|s| s.effect.as_str()), Some("viscous"), "{}", found.summary);
}

#[test]
fn a_fit_predicts_its_own_run_as_it_was_fitted() {
    // Three effects with other forms, which enter in another order than that of the library.
    let run = one_sine(&[]);
    let spec =
        ModelSpec::parse(Kind::Friction, "inertia, coulomb, viscous, stribeck, viscous_sublinear, cogging").unwrap();
    let found = fit(&run, &spec, &Options::default()).unwrap();
    let again = evaluate(&found, &run).unwrap();
    assert!((again.rms / found.rms - 1.0).abs() < 1e-6, "{} instead of {}", again.rms, found.rms);
}
