//! The encoder bench: a shaft with two encoders, and nothing that brakes it.

use jointbench_devices::sim::{MockInstrument, Trouble};
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::units::{Amperes, RadPerSec};

#[test]
fn every_slot_that_an_encoder_bench_has_is_filled() {
    let mock = MockBench::start(MockSettings::new(Joint::EncoderShaft, 3)).unwrap();
    let mut bench = mock.open_bench("mock").unwrap();
    assert!(bench.torque_sensor.is_none() && bench.brake.is_none());
    assert_eq!(bench.limits.brake_power_w, 0.0);
    let felt = bench.thermometer.as_mut().unwrap().read().unwrap();
    assert!(felt.iter().all(|t| (t.0 - 24.0).abs() < 1.0), "{felt:?}");
    assert!(!bench.stage.as_mut().unwrap().is_referenced().unwrap());
    assert!(bench.reference_encoder.as_mut().unwrap().status().is_none());
    let encoder = bench.test_encoder.as_mut().unwrap();
    assert!(encoder.status().expect("wired").periods_are_consistent().unwrap());

    // 100 rad/s, both ways, and all three count alike.
    bench.joint.arm(RadPerSec(200.0), Amperes(5.0)).unwrap();
    for (velocity_rad_s, turned_rad) in [(100.0, 50.0), (-100.0, -50.0)] {
        let mut drive = |seconds: f64| {
            let end_s = bench.clock.now_s() + seconds;
            while bench.clock.now_s() < end_s {
                bench.joint.set_velocity(RadPerSec(velocity_rad_s)).unwrap();
                bench.clock.sleep_until_s(bench.clock.now_s() + 0.01);
            }
            let encoders = [&mut bench.reference_encoder, &mut bench.test_encoder];
            let [s1, s2] = encoders.map(|encoder| encoder.as_mut().unwrap().read().unwrap().position.0);
            (bench.joint.read().unwrap().motor_position.0, s1, s2)
        };
        let (before, after) = (drive(0.5), drive(0.5));
        let turned = [after.0 - before.0, after.1 - before.1, after.2 - before.2];
        assert!(turned.iter().all(|turned| (turned - turned_rad).abs() < 0.5), "{turned:?} rad");
    }
}

#[test]
fn half_an_encoder_bench_is_none() {
    let mock = MockBench::start(MockSettings::new(Joint::EncoderShaft, 3)).unwrap();
    mock.trouble(MockInstrument::Stage, Trouble::Refusing);
    let opened = mock.instruments().open(&mock.clock());
    let failed: Vec<_> = opened.asked.iter().filter(|asked| asked.identity.is_err()).map(|asked| asked.role).collect();
    assert_eq!((failed, opened.asked.len()), (vec!["stage"], 5));
    assert!(mock.open_bench("mock").is_err());
}
