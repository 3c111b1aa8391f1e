//! Effects of cable troubles on replies.

use super::{DEADLINE, ask, start};
use jointbench_devices::sim::{MockInstrument, Transport, Trouble};
use jointbench_devices::{
    Joint, MockBench, MockSettings, OdriveJoint, OdriveSettings, PortSettings, ScpiSettings, ScpiSource,
};
use jointbench_instrument::FaultKind;
use jointbench_instrument::units::{Amperes, NewtonMetres, RadPerSec};
use std::time::{Duration, Instant};

/// The fault is reported within two deadlines, persists during the trouble, and ends with it.
fn check_passing(trouble: Trouble, expected: fn(&FaultKind) -> bool) {
    let check = |transport, instrument| {
        let (mock, mut bench) = start(transport);
        ask(&mut bench, instrument).unwrap();
        mock.trouble(instrument, trouble);
        let asked = Instant::now();
        let fault = ask(&mut bench, instrument).unwrap_err();
        assert!(asked.elapsed() < 2 * DEADLINE, "{fault} after {:?}", asked.elapsed());
        assert!(expected(&fault.kind) && fault.is_retryable(), "{instrument:?} over {transport:?}: {fault}");
        assert!(ask(&mut bench, instrument).is_err(), "{instrument:?}: still in trouble");
        mock.trouble(instrument, Trouble::None);
        ask(&mut bench, instrument).unwrap_or_else(|fault| panic!("{instrument:?} does not recover: {fault}"));
    };
    // In parallel, because most of the time is spent waiting for deadlines.
    std::thread::scope(|scope| {
        for transport in [Transport::Terminal, Transport::Tcp, Transport::Inside] {
            for instrument in MockInstrument::JOINT_BENCH {
                scope.spawn(move || check(transport, instrument));
            }
        }
    });
}

#[test]
fn a_silent_instrument_is_seen_and_comes_back() {
    check_passing(Trouble::Silent, |kind| matches!(kind, FaultKind::Silent { .. }));
}

#[test]
fn a_missed_deadline_counts_in_the_link_latency() {
    let (mock, mut bench) = start(Transport::Inside);
    let counter = bench.joint.latency_counter().unwrap();
    counter.take();
    ask(&mut bench, MockInstrument::Joint).unwrap();
    let answered = counter.take();
    mock.trouble(MockInstrument::Joint, Trouble::Silent);
    ask(&mut bench, MockInstrument::Joint).unwrap_err();
    let silent = counter.take();
    assert!(answered.count() > 0 && answered.sum_s() < DEADLINE.as_secs_f64(), "{answered:?}");
    assert!(silent.count() == 1 && silent.sum_s() >= DEADLINE.as_secs_f64(), "{silent:?}");
}

#[test]
fn a_garbled_reply_is_no_reading() {
    check_passing(Trouble::Garbled, |kind| matches!(kind, FaultKind::Garbled { .. }));
}

#[test]
fn half_a_reply_is_no_reading() {
    check_passing(Trouble::Truncated, |kind| matches!(kind, FaultKind::Garbled { .. }));
}

#[test]
fn the_reply_to_an_earlier_question_answers_no_later_one() {
    check_passing(Trouble::Stale, |kind| matches!(kind, FaultKind::Silent { .. }));
}

#[test]
fn a_second_copy_of_a_reply_is_discarded() {
    for transport in [Transport::Terminal, Transport::Tcp, Transport::Inside] {
        let (mock, mut bench) = start(transport);
        for instrument in MockInstrument::JOINT_BENCH {
            mock.trouble(instrument, Trouble::Doubled);
            // The first reply is right. Its copy precedes the next reply, or arrives with the first one.
            let fault = (0..2).find_map(|_| ask(&mut bench, instrument).err()).expect("the copy is noticed");
            assert!(matches!(fault.kind, FaultKind::Garbled { .. }), "{instrument:?} over {transport:?}: {fault}");
            mock.trouble(instrument, Trouble::None);
            ask(&mut bench, instrument).unwrap_or_else(|fault| panic!("{instrument:?} does not recover: {fault}"));
        }
    }
}

#[test]
fn a_late_reply_answers_no_later_question() {
    check_passing(Trouble::Late, |kind| matches!(kind, FaultKind::Silent { .. }));

    let (mock, mut bench) = start(Transport::Terminal);
    mock.trouble(MockInstrument::Joint, Trouble::Late);
    assert!(bench.joint.read().is_err());
    bench.clock.sleep_until_s(0.02);
    let before = bench.clock.now_s();
    mock.trouble(MockInstrument::Joint, Trouble::None);
    bench.joint.set_velocity(RadPerSec(20.0)).unwrap();
    bench.clock.sleep_until_s(before + 0.2);
    let reading = bench.joint.read().unwrap();
    assert!((reading.motor_velocity.0 - 20.0).abs() < 2.0, "{reading:?}: the reply of long ago said 0");
}

#[test]
fn a_pulled_cable_is_a_lost_port() {
    for transport in [Transport::Terminal, Transport::Tcp, Transport::Inside] {
        let (mock, mut bench) = start(transport);
        for instrument in MockInstrument::JOINT_BENCH {
            mock.trouble(instrument, Trouble::Unplugged);
            let asked = Instant::now();
            // The instrument may still answer until the cable is unplugged.
            let fault = loop {
                match ask(&mut bench, instrument) {
                    Err(fault) => break fault,
                    Ok(()) => assert!(asked.elapsed() < 2 * DEADLINE, "{instrument:?} still answers"),
                }
            };
            assert!(matches!(fault.kind, FaultKind::Disconnected { .. }), "{instrument:?}: {fault}");
            assert!(!fault.is_retryable() && fault.to_string().contains("cable"));
            assert!(ask(&mut bench, instrument).is_err());
        }
    }
}

#[test]
fn a_plugged_cable_is_found_again() {
    let (mock, mut bench) = start(Transport::Tcp);
    mock.trouble(MockInstrument::Joint, Trouble::Unplugged);
    while ask(&mut bench, MockInstrument::Joint).is_ok() {}
    mock.trouble(MockInstrument::Joint, Trouble::None);
    assert!(bench.joint.recover().unwrap().model.contains("ODrive"));
    bench.joint.read().unwrap();

    let (mock, mut bench) = start(Transport::Terminal);
    mock.trouble(MockInstrument::TorqueSensor, Trouble::Unplugged);
    while ask(&mut bench, MockInstrument::TorqueSensor).is_ok() {}
    drop(bench);
    mock.trouble(MockInstrument::TorqueSensor, Trouble::None);
    // The terminal returns under the new name that the system gives it.
    let plugged = Instant::now();
    while mock.open_bench("again").is_err() {
        assert!(plugged.elapsed() < Duration::from_secs(5), "not back");
    }
}

#[test]
fn another_instrument_behind_the_port_is_named() {
    let mock = MockBench::start(MockSettings::new(Joint::JointA, 4)).unwrap();
    let deadline_ms = 300;
    let joint = OdriveSettings {
        name: "joint".into(),
        port: PortSettings::new(mock.address(MockInstrument::Brake).unwrap(), 115_200),
        deadline_ms,
        link_encoder: false,
        thermistor: None,
    };
    let Err(fault) = OdriveJoint::open(joint, mock.clock()) else { panic!("a supply passed for a drive") };
    assert!(fault.to_string().starts_with("joint on mock:"), "{fault}");
    let port = PortSettings::new(mock.address(MockInstrument::Joint).unwrap(), 115_200);
    let Err(fault) = ScpiSource::open(ScpiSettings { name: "brake_a".into(), port, deadline_ms }) else {
        panic!("a drive passed for a supply")
    };
    assert!(fault.to_string().starts_with("brake_a on mock:"), "{fault}");
}

#[test]
fn safe_commands_go_out_on_a_broken_link() {
    let (mock, mut bench) = start(Transport::Terminal);
    bench.brake.as_mut().unwrap().set_current(Amperes(0.2)).unwrap();
    bench.clock.sleep_until_s(0.4);
    for instrument in [MockInstrument::Joint, MockInstrument::Brake] {
        mock.trouble(instrument, Trouble::Silent);
        assert!(ask(&mut bench, instrument).is_err());
    }
    bench.joint.disarm().unwrap();
    assert!(bench.brake.as_mut().unwrap().output_off().is_err(), "nothing confirms it");
    for instrument in [MockInstrument::Joint, MockInstrument::Brake] {
        mock.trouble(instrument, Trouble::None);
    }
    assert!(!bench.joint.health().unwrap().armed, "it was taken all the same");
    bench.clock.sleep_until_s(2.0);
    let reading = bench.brake.as_mut().unwrap().read().unwrap();
    assert!(reading.current.0 < 0.001, "{reading:?}");
}

#[test]
fn bad_set_points_never_reach_the_wire() {
    let (_mock, mut bench) = start(Transport::Terminal);
    for velocity in [f64::NAN, f64::INFINITY] {
        let fault = bench.joint.set_velocity(RadPerSec(velocity)).unwrap_err();
        assert!(matches!(fault.kind, FaultKind::Refused { .. }), "{fault}");
    }
    bench.joint.read().unwrap();
    assert_eq!(bench.torque_sensor.as_mut().unwrap().range(), NewtonMetres(20.0));
}
