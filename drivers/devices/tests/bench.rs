//! The ordinary drivers on the mock bench's wires.

use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::Bench;
use jointbench_instrument::roles::Regulation;
use jointbench_instrument::units::{Amperes, RadPerSec, Volts};
use std::f64::consts::TAU;
use std::thread::sleep;
use std::time::{Duration, Instant};

const PERIOD_S: f64 = 0.004;

/// Mean of the rows of one stretch at constant set-points: velocity, motor torque, link torque.
#[derive(Debug, Default, Clone, Copy)]
struct Mean {
    velocity_rad_s: f64,
    motor_nm: f64,
    link_nm: f64,
}

/// Runs at `velocity_rad_s` and averages the last `keep_s`.
fn stretch(bench: &mut Bench, velocity_rad_s: f64, settle_s: f64, keep_s: f64) -> Mean {
    let start_s = bench.clock.now_s();
    let (mut mean, mut rows) = (Mean::default(), 0.0);
    for tick in 1.. {
        bench.joint.set_velocity(RadPerSec(velocity_rad_s)).unwrap();
        bench.clock.sleep_until_s(start_s + f64::from(tick) * PERIOD_S);
        let joint = bench.joint.read().unwrap();
        let torque = bench.torque_sensor.as_mut().unwrap().read().unwrap();
        let elapsed_s = bench.clock.now_s() - start_s;
        if elapsed_s > settle_s {
            mean.velocity_rad_s += joint.motor_velocity.0;
            mean.motor_nm += joint.motor_current.0 * bench.constants.torque_constant_nm_per_a;
            mean.link_nm += torque.0;
            rows += 1.0;
        }
        if elapsed_s >= settle_s + keep_s {
            break;
        }
    }
    Mean { velocity_rad_s: mean.velocity_rad_s / rows, motor_nm: mean.motor_nm / rows, link_nm: mean.link_nm / rows }
}

fn open(settings: MockSettings) -> (MockBench, Bench) {
    let mock = MockBench::start(settings).unwrap();
    let bench = mock.open_bench("mock").unwrap();
    (mock, bench)
}

fn arm(bench: &mut Bench) {
    bench.joint.arm(RadPerSec(300.0), Amperes(6.0)).unwrap();
    let compliance = Volts(bench.constants.brake_compliance_v);
    bench.brake.as_mut().unwrap().prepare(compliance).unwrap();
}

/// Without hidden effects, motor torque minus the load is only Coulomb and viscous friction.
fn check_baseline(joint: Joint, velocities_rad_s: &[f64], budget_nm: f64) {
    let (mock, mut bench) = open(MockSettings::new(joint, 7));
    arm(&mut bench);
    let truth = mock.truth().clone();
    assert!(truth.hidden.is_empty());
    for current_a in [0.0, 0.35] {
        bench.brake.as_mut().unwrap().set_current(Amperes(current_a)).unwrap();
        for velocity_rad_s in velocities_rad_s.iter().flat_map(|v| [*v, -*v]) {
            // The brake's rotor winds up over a fraction of a degree before it slips, which takes long at low speed.
            let mean = stretch(&mut bench, velocity_rad_s, 1.2 + 5.0 / velocity_rad_s.abs(), 1.2);
            let friction_nm = mean.motor_nm - mean.link_nm / truth.gear_ratio;
            let expected_nm = truth.coulomb_nm * velocity_rad_s.signum() + truth.viscous_nm_s * mean.velocity_rad_s;
            assert!(
                (friction_nm - expected_nm).abs() < budget_nm,
                "{joint:?} at {velocity_rad_s} rad/s: {friction_nm:.5} Nm, expected {expected_nm:.5} Nm ({mean:?})"
            );
            assert!((mean.velocity_rad_s - velocity_rad_s).abs() < 0.02 * velocity_rad_s.abs() + 0.05, "{mean:?}");
        }
    }
}

#[test]
fn nothing_hidden_is_coulomb_and_viscous_on_joint_a() {
    check_baseline(Joint::JointA, &[2.0, 10.0, 150.0], 6e-4);
}

#[test]
fn nothing_hidden_is_coulomb_and_viscous_on_joint_b() {
    check_baseline(Joint::JointB, &[2.0, 10.0, 150.0], 1.2e-3);
}

#[test]
fn the_drive_reports_what_it_is_and_stands_down() {
    let (_mock, mut bench) = open(MockSettings::new(Joint::JointA, 1));
    assert_eq!(bench.joint.identify().unwrap().model, "ODrive 3.6-56V");
    assert!(!bench.joint.health().unwrap().armed);
    arm(&mut bench);
    stretch(&mut bench, 50.0, 0.0, 0.4);
    let health = bench.joint.health().unwrap();
    assert!(health.armed && health.errors.is_empty(), "{health:?}");
    assert!(
        (20.0..40.0).contains(&health.temperature.unwrap().0) && health.bus_voltage.unwrap().0 > 20.0,
        "{health:?}"
    );
    bench.joint.disarm().unwrap();
    assert!(!bench.joint.health().unwrap().armed);
    bench.clock.sleep_until_s(bench.clock.now_s() + 1.0);
    let reading = bench.joint.read().unwrap();
    assert!(reading.motor_velocity.0.abs() < 0.01 && reading.motor_current.0.abs() < 0.4, "{reading:?}");
    assert!(bench.joint.health().unwrap().errors.is_empty(), "the watchdog was switched off");
}

#[test]
fn a_drive_that_is_forgotten_stands_down_by_itself() {
    let (_mock, mut bench) = open(MockSettings::new(Joint::JointA, 1));
    arm(&mut bench);
    stretch(&mut bench, 50.0, 0.0, 0.2);
    bench.clock.sleep_until_s(bench.clock.now_s() + 0.5);
    let health = bench.joint.health().unwrap();
    assert!(!health.armed);
    assert_eq!(health.errors, ["axis WATCHDOG_TIMER_EXPIRED"]);
    bench.joint.arm(RadPerSec(300.0), Amperes(6.0)).unwrap();
    assert!(bench.joint.health().unwrap().armed);
}

#[test]
fn the_brake_follows_late_and_holds_its_current() {
    let (_mock, mut bench) = open(MockSettings::new(Joint::JointB, 3));
    arm(&mut bench);
    let free = stretch(&mut bench, 60.0, 0.5, 0.3);
    let clock = bench.clock.clone();
    let brake = bench.brake.as_mut().unwrap();
    let set_s = clock.now_s();
    brake.set_current(Amperes(0.6)).unwrap();
    clock.sleep_until_s(set_s + 0.11);
    assert!(brake.read().unwrap().current.0 < 0.002, "118 ms pass before the output changes");
    let braked = stretch(&mut bench, 60.0, 1.0, 0.3);
    assert!((12.0..14.5).contains(&(braked.link_nm - free.link_nm)), "{free:?} {braked:?}");
    let brake = bench.brake.as_mut().unwrap();
    let reading = brake.read().unwrap();
    assert!((reading.current.0 - 0.6).abs() < 0.002, "{reading:?}");
    assert_eq!(reading.regulation, Regulation::ConstantCurrent);
    // At half the rating, the torque on the falling branch is larger than on the rising branch.
    brake.set_current(Amperes(0.3)).unwrap();
    let falling = stretch(&mut bench, 60.0, 1.0, 0.3);
    let brake = bench.brake.as_mut().unwrap();
    brake.set_current(Amperes(0.0)).unwrap();
    stretch(&mut bench, 60.0, 1.0, 0.1);
    bench.brake.as_mut().unwrap().set_current(Amperes(0.3)).unwrap();
    let rising = stretch(&mut bench, 60.0, 1.0, 0.3);
    assert!((0.4..1.2).contains(&(falling.link_nm - rising.link_nm)), "{falling:?} {rising:?}");
    let brake = bench.brake.as_mut().unwrap();
    brake.output_off().unwrap();
    assert_eq!(brake.read().unwrap().regulation, Regulation::Off);
}

#[test]
fn too_little_voltage_is_seen_as_constant_voltage() {
    let (_mock, mut bench) = open(MockSettings::new(Joint::JointB, 3));
    let clock = bench.clock.clone();
    let brake = bench.brake.as_mut().unwrap();
    brake.prepare(Volts(20.0)).unwrap();
    brake.set_current(Amperes(0.6)).unwrap();
    clock.sleep_until_s(1.0);
    let reading = brake.read().unwrap();
    assert_eq!(reading.regulation, Regulation::ConstantVoltage);
    assert!(reading.current.0 < 0.4, "{reading:?}");
    assert!(brake.set_current(Amperes(1.2)).unwrap_err().to_string().contains("-222"), "beyond the supply");
    assert!(brake.set_current(Amperes(f64::NAN)).is_err());
    assert!(brake.set_current(Amperes(0.1)).is_ok(), "usable after a refusal");
}

#[test]
fn the_same_seed_tells_the_same_story() {
    let story = |seed| {
        let (mock, mut bench) = open(MockSettings::new(Joint::JointA, seed).hiding(&["stribeck", "gravity"]));
        arm(&mut bench);
        let means: Vec<f64> = [5.0, -40.0].into_iter().map(|v| stretch(&mut bench, v, 0.1, 0.3).motor_nm).collect();
        (means, mock.truth().clone())
    };
    assert_eq!(story(11), story(11));
    assert_ne!(story(11).0, story(12).0);
}

#[test]
fn every_effect_can_be_hidden_and_shows_in_the_truth() {
    let started = |joint: Joint, effect: &str| MockBench::start(MockSettings::new(joint, 5).hiding(&[effect]));
    for joint in [Joint::JointB, Joint::EncoderShaft] {
        for effect in joint.hides() {
            let mock = started(joint, effect).unwrap();
            let hidden = &mock.truth().hidden;
            assert_eq!(hidden.len(), 1);
            assert_eq!(hidden[0].effect, effect);
            assert!(!hidden[0].parameters.is_empty());
        }
    }
    for (joint, effect, known) in [
        (Joint::JointB, "magic", "hardening"),
        (Joint::JointB, "slip", "velocity_dependence"),
        (Joint::EncoderShaft, "hardening", "slip"),
        (Joint::Puma, "slip", "stribeck"),
    ] {
        let Err(error) = started(joint, effect) else { panic!("{joint:?} has taken {effect}") };
        assert!(error.to_string().contains(effect) && error.to_string().contains(known), "{error}");
    }
}

#[test]
fn one_port_has_one_owner() {
    let (mock, bench) = open(MockSettings::new(Joint::JointA, 1));
    let Err(fault) = mock.open_bench("second") else { panic!("a port was opened twice") };
    assert!(matches!(fault.kind, jointbench_instrument::FaultKind::NotOpened { .. }), "{fault}");
    drop(bench);
    mock.open_bench("third").unwrap();
}

#[test]
fn a_bench_that_stood_still_does_not_race_to_make_up_for_it() {
    let mock = MockBench::start(MockSettings { pace: Some(10.0), ..MockSettings::new(Joint::JointA, 1) }).unwrap();
    let clock = mock.clock();
    sleep(Duration::from_millis(400));
    let begun = Instant::now();
    clock.sleep_until_s(clock.now_s() + 4.0);
    let took_s = begun.elapsed().as_secs_f64();
    assert!(took_s > 0.28, "4 s at ten times the pace of the wall passed in {took_s} s");
}

/// The bench of the documents has the same values for every seed.
#[test]
fn the_bench_of_the_documents_has_exactly_their_values() {
    let started = |joint, axis, seed| {
        let settings = MockSettings { documents: true, axis, ..MockSettings::new(joint, seed) };
        let mock = MockBench::start(settings.hiding(&["stribeck"])).unwrap();
        (mock.truth().clone(), mock.settings().constants())
    };
    for seed in [1, 7] {
        for (joint, [coulomb_nm, viscous_nm_s, rise_nm, stribeck_rad_s, exponent]) in
            [(Joint::JointA, [0.030, 1.512e-4, 0.009, 0.06, 0.8]), (Joint::JointB, [0.031, 7.835e-5, 0.026, 0.08, 1.9])]
        {
            let (truth, constants) = started(joint, 2, seed);
            assert_eq!((truth.coulomb_nm, truth.viscous_nm_s), (coulomb_nm, viscous_nm_s));
            let [stribeck] = &truth.hidden[..] else { panic!("{:?}", truth.hidden) };
            let given = ["rise_nm", "velocity_rad_s", "exponent"].map(|name| stribeck.parameters[name]);
            let expected = [rise_nm, stribeck_rad_s * truth.gear_ratio, exponent];
            assert!(given.iter().zip(expected).all(|(given, expected)| (given - expected).abs() < 1e-12), "{given:?}");
            assert_eq!(constants.brake_rated_torque_nm, 15.0);
        }
        let offset_rad = started(Joint::EncoderShaft, 2, seed).0.encoders.offset_rad;
        assert!((offset_rad * f64::from(1 << 18) / TAU - 1437.0).abs() < 1e-9);
        // Table 3.1: Coulomb friction in both directions, and mean viscous friction.
        for (axis, coulomb_nm, viscous_nm_s) in [
            (1, [0.435, 0.395], 1.48e-3),
            (2, [0.126, 0.0709], 0.817e-3),
            (3, [0.105, 0.132], 1.38e-3),
            (4, [11.2e-3, 16.9e-3], 71.2e-6),
            (5, [9.26e-3, 14.5e-3], 82.6e-6),
            (6, [3.96e-3, 10.5e-3], 36.7e-6),
        ] {
            let (truth, _) = started(Joint::Puma, axis, seed);
            let offset = truth.hidden.iter().find(|hidden| hidden.effect == "direction_offset").unwrap();
            let offset_nm = offset.parameters["offset_nm"];
            for (expected_nm, sign) in coulomb_nm.into_iter().zip([1.0, -1.0]) {
                let found_nm = truth.coulomb_nm + sign * offset_nm;
                assert!((found_nm / expected_nm - 1.0).abs() < 5e-3, "axis {axis}: {found_nm} Nm");
            }
            assert!((truth.viscous_nm_s / viscous_nm_s - 1.0).abs() < 5e-3, "axis {axis}: {}", truth.viscous_nm_s);
        }
    }
}

/// A position loop without feed-forward lags behind the integral of its set-point, friction in addition.
#[test]
fn the_joints_of_the_documents_lag_behind_their_set_point() {
    for (joint, gain_per_s) in [(Joint::JointA, 23.3), (Joint::JointB, 24.0)] {
        let (_mock, mut bench) = open(MockSettings { documents: true, ..MockSettings::new(joint, 1) });
        arm(&mut bench);
        let (velocity_rad_s, duration_s) = (20.0, 1.5);
        let start_rad = bench.joint.read().unwrap().motor_position.0;
        stretch(&mut bench, velocity_rad_s, 0.0, duration_s);
        let moved_rad = bench.joint.read().unwrap().motor_position.0 - start_rad;
        let lag_rad = velocity_rad_s * duration_s - moved_rad;
        let expected_rad = velocity_rad_s / gain_per_s;
        assert!((1.02..1.5).contains(&(lag_rad / expected_rad)), "{joint:?}: {lag_rad} rad, {expected_rad} rad");
    }
}
