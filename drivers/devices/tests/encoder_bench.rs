//! The encoder bench: a shaft with two encoders and no load.

use jointbench_devices::sim::{MockInstrument, Trouble};
use jointbench_devices::transport::{Event, Traffic};
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::units::{Amperes, RadPerSec};

#[test]
fn every_slot_that_an_encoder_bench_has_is_filled() {
    let mock = MockBench::start(MockSettings::new(Joint::EncoderShaft, 3)).unwrap();
    let mut bench = mock.open_bench("mock").unwrap();
    assert!(bench.torque_sensor.is_none() && bench.brake.is_none());
    assert_eq!(bench.limits.brake_power_w, 0.0);
    let temperatures = bench.thermometer.as_mut().unwrap().read().unwrap();
    assert!(temperatures.iter().all(|t| (t.0 - 24.0).abs() < 1.0), "{temperatures:?}");
    assert!(!bench.stage.as_mut().unwrap().is_referenced().unwrap());
    assert!(bench.reference_encoder.as_mut().unwrap().status().is_none());
    let encoder = bench.test_encoder.as_mut().unwrap();
    assert!(encoder.status().expect("wired").periods_are_consistent().unwrap());

    // 100 rad/s in both directions: all three encoders agree.
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

/// The bytes that every instrument sent in the same conversation.
fn sent_bytes(seed: u64) -> Vec<(String, Vec<u8>)> {
    let folder = tempfile::tempdir().unwrap();
    let mock = MockBench::start(MockSettings::new(Joint::EncoderShaft, seed)).unwrap();
    let mut settings = mock.instruments();
    settings.record_in(folder.path());
    let mut bench = settings.open(&mock.clock());
    let clock = mock.clock();
    let wait = |seconds: f64| clock.sleep_until_s(clock.now_s() + seconds);
    let (joint, stage) = (bench.joint.as_mut().unwrap(), bench.stage.as_mut().unwrap());
    stage.reference().unwrap();
    joint.arm(RadPerSec(200.0), Amperes(5.0)).unwrap();
    for reading in 0..200 {
        joint.set_velocity(RadPerSec(f64::from(reading))).unwrap();
        wait(0.03);
        joint.read().unwrap();
        for encoder in [&mut bench.reference_encoder, &mut bench.test_encoder] {
            encoder.as_mut().unwrap().read().unwrap();
        }
        stage.pose().unwrap();
        bench.thermometer.as_mut().unwrap().read().unwrap();
    }
    drop(bench);
    let bytes = |file: &std::path::Path| -> Vec<u8> {
        let traffic = Traffic::parse(&std::fs::read_to_string(file).unwrap()).unwrap();
        let received = traffic.events.into_iter().filter_map(|(_, event)| match event {
            Event::Received(bytes) => Some(bytes),
            _ => None,
        });
        received.flatten().collect()
    };
    let mut files: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|file| file.unwrap().path()).collect();
    files.sort();
    files.iter().map(|file| (file.file_stem().unwrap().to_str().unwrap().to_owned(), bytes(file))).collect()
}

#[test]
fn the_same_seed_sends_the_same_bytes_and_another_one_does_not() {
    let (once, again, other) = (sent_bytes(11), sent_bytes(11), sent_bytes(12));
    assert_eq!(
        once.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
        ["joint", "s1", "s2", "stage", "thermometer"]
    );
    for ((name, once), (_, again)) in once.iter().zip(&again) {
        assert!(once == again && !once.is_empty(), "{name}");
    }
    for ((name, once), (_, other)) in once.iter().zip(&other).filter(|((name, _), _)| name != "s1") {
        assert_ne!(once, other, "{name}");
    }
}
