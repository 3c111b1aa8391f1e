//! A trajectory whose joint sticks at its reversals: the friction there is no function of the sign of the speed.

mod common;

use common::tables::{meta, scatter};
use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use jointbench_model::{Diagnosis, ModelSpec, Options, diagnose};
use std::f64::consts::TAU;

const STEP_S: f64 = 5e-4;
/// Simulation steps for each row.
const EVERY: usize = 8;
/// Inertia [kg·m²], dry friction [Nm] and viscous friction [Nm·s/rad].
const INERTIA: f64 = 1e-4;
const DRY: f64 = 0.02;
const VISCOUS: f64 = 5e-5;
/// Disturbance torque of the joint [Nm].
const DISTURBANCE: f64 = 2.5e-3;
/// Delay of the drive's speed estimate against the position [s].
const ESTIMATE_S: f64 = 2e-3;

/// A period of the motion in simulation steps: 16 s.
const PERIOD: usize = 32_000;

/// Speed set-point of the controller [rad/s].
fn wanted(step: usize) -> f64 {
    let t = (step % PERIOD) as f64 / PERIOD as f64;
    let wave = |times: f64, phase: f64| (TAU * times * t + phase).sin();
    40.0 * (wave(2.0, 0.4) + 0.7 * wave(5.0, 1.9) + 0.6 * wave(11.0, 4.0) + 0.5 * wave(17.0, 2.5))
}

/// Four repeats of one motion under a speed controller. The current is read with a delay of `delayed` steps, and the
/// presliding displacement is `reach` [rad].
fn moving(delayed: usize, reach: f64) -> RunTable {
    let names = "time_s motor_position_rad motor_velocity_rad_s motor_current_a repeat";
    let mut trace = Trace::new(names.split(' ').map(Channel::new).collect());
    let gain = INERTIA * TAU * 18.0;
    let (mut speed, mut estimate) = (wanted(0), wanted(0));
    let (mut position, mut sum, mut bent) = (0.0, 0.0, 1.0f64);
    let mut torques = vec![0.0; delayed + 1];
    for i in 0..4 * PERIOD {
        let wanted = wanted(i);
        let error = wanted - estimate;
        sum += error * STEP_S;
        let torque = gain * (error + TAU * 3.0 * sum) + DISTURBANCE * scatter(i / 40, 2);
        // Presliding contacts, or dry friction that holds up to its limit.
        let friction = match reach > 0.0 {
            true => DRY * bent,
            false => ((torque - VISCOUS * speed) + INERTIA * speed / STEP_S).clamp(-DRY, DRY),
        };
        speed += (torque - VISCOUS * speed - friction) * STEP_S / INERTIA;
        bent = (bent + speed * STEP_S / reach.max(1e-9)).clamp(-1.0, 1.0);
        position += speed * STEP_S;
        estimate += (speed - estimate) * STEP_S / ESTIMATE_S;
        torques.push(torque);
        if i % EVERY == 0 {
            let read = torques[torques.len() - 1 - delayed] + 1e-3 * scatter(i, 5);
            let velocity = estimate + 0.05 * scatter(i, 7);
            trace.push_row(&[STEP_S * i as f64, position, velocity, read / 0.08, (i / PERIOD) as f64]);
        }
    }
    let baseline = ["inertia", "coulomb", "viscous"].map(String::from).into();
    RunTable::new(Meta { gear_ratio: Some(1.0), baseline, ..meta(Kind::Friction) }, trace).unwrap()
}

fn diagnosed(delayed: usize, reach: f64) -> (Vec<String>, Diagnosis) {
    let run = moving(delayed, reach);
    let found = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
    (found.suggestions.iter().map(|s| s.effect.clone()).collect(), found)
}

#[test]
fn a_joint_that_sticks_hides_nothing() {
    let (named, found) = diagnosed(0, 0.0);
    assert!(named.is_empty(), "{}", found.summary);
    // 2.0 mNm if the reversals count. The residual with nuisance columns still exceeds the noise.
    assert!(found.fit.validation_rms < 5e-4, "{}", found.summary);
    for (name, truth) in [("j", INERTIA), ("tau_c", DRY), ("c_v", VISCOUS)] {
        let value = found.fit.parameters.iter().find(|p| p.name == name).unwrap().value;
        assert!((value / truth - 1.0).abs() < 0.02, "{name}: {value} instead of {truth}");
    }
    // No row is removed: the form error has nuisance terms, which are reported.
    assert!(found.fit.notes.iter().any(|note| note.starts_with("nuisance terms (")), "{:?}", found.fit.notes);
}

#[test]
fn a_delayed_current_is_named_alone() {
    let (named, found) = diagnosed(16, 0.0);
    assert_eq!(named, ["signal_delay"], "{}", found.summary);
}

/// Which of two possible moments the torque of a row belongs to is unknown.
#[test]
fn a_current_between_position_and_velocity_has_no_delay() {
    let (named, found) = diagnosed(2, 0.0);
    assert!(named.is_empty(), "{}", found.summary);
}

#[test]
fn contacts_that_bend_are_seen_at_reversals() {
    let (named, found) = diagnosed(0, 0.4);
    assert_eq!(named, ["presliding"], "{}", found.summary);
    // Presliding is the direction of its model, not a term of it: without it, the last model is the given one.
    let one = &found.suggestions[0];
    let (alone, together) = (one.error_reduction, one.error_reduction_together);
    assert!(alone != 0.0 && (together - alone).abs() < 1e-9, "{alone} alone, {together} together");
    assert!(one.reasons.starts_with("Without the nuisance terms that imitate it, "), "{}", one.reasons);
}
