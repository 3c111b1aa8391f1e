//! Troubles of the counters, the thermometer, the stage and the multimeter.

use super::{DEADLINE, settings};
use jointbench_devices::sim::{MockInstrument, Transport, Trouble};
use jointbench_devices::{
    AdamSettings, AdamThermometer, DmmSettings, DmmTorqueSensor, GcsSettings, GcsStage, MockBench, MockSettings,
    PortSettings, QsbCounter, QsbSettings,
};
use jointbench_instrument::roles::{
    AlignmentStage, EncoderStatus, Instrument, Pose, PositionCounter, Thermometer, TorqueSensor,
};
use jointbench_instrument::units::{Amperes, RadPerSec};
use jointbench_instrument::{Fault, FaultKind};

const OTHERS: [MockInstrument; 5] = [
    MockInstrument::Multimeter,
    MockInstrument::CounterS1,
    MockInstrument::CounterS2,
    MockInstrument::Thermometer,
    MockInstrument::Stage,
];

fn start(transport: Transport) -> MockBench {
    MockBench::start(MockSettings { others: OTHERS.to_vec(), ..settings(transport) }).unwrap()
}

fn counter(mock: &MockBench, instrument: MockInstrument) -> QsbCounter {
    let counts_per_turn = if instrument == MockInstrument::CounterS1 { 16_384 } else { 262_144 };
    let settings = QsbSettings {
        name: "counter".into(),
        port: PortSettings::new(mock.address(instrument).unwrap(), 230_400),
        deadline_ms: DEADLINE.as_millis() as u64,
        counts_per_turn,
        reversed: false,
        status_input: Some(0),
    };
    QsbCounter::open(settings, mock.clock()).unwrap()
}

fn thermometer(mock: &MockBench) -> AdamThermometer {
    let settings = AdamSettings {
        name: "thermometer".into(),
        port: PortSettings::new(mock.address(MockInstrument::Thermometer).unwrap(), 9600),
        deadline_ms: DEADLINE.as_millis() as u64,
        slave: 1,
        channels: vec![0, 1, 5],
    };
    AdamThermometer::open(settings).unwrap()
}

fn stage(mock: &MockBench) -> GcsStage {
    let port = PortSettings::new(mock.address(MockInstrument::Stage).unwrap(), 115_200);
    let settings = GcsSettings { name: "stage".into(), port, deadline_ms: DEADLINE.as_millis() as u64 };
    GcsStage::open(settings).unwrap()
}

fn multimeter(mock: &MockBench) -> DmmTorqueSensor {
    let port = PortSettings::new(mock.address(MockInstrument::Multimeter).unwrap(), 9600);
    let deadline_ms = DEADLINE.as_millis() as u64;
    DmmTorqueSensor::open(DmmSettings { name: "multimeter".into(), port, deadline_ms, nominal_nm: 20.0 }).unwrap()
}

/// A use of the instrument that needs a reply.
fn user(mock: &MockBench, instrument: MockInstrument) -> Box<dyn FnMut() -> Result<(), Fault>> {
    if instrument == MockInstrument::Thermometer {
        let mut thermometer = thermometer(mock);
        return Box::new(move || thermometer.read().map(drop));
    }
    if instrument == MockInstrument::Multimeter {
        let mut multimeter = multimeter(mock);
        return Box::new(move || multimeter.read().map(drop));
    }
    if instrument == MockInstrument::Stage {
        let mut stage = stage(mock);
        return Box::new(move || stage.pose().map(drop));
    }
    let mut counter = counter(mock, instrument);
    Box::new(move || counter.read().map(drop))
}

#[test]
fn a_passing_trouble_is_seen_and_over_when_it_is() {
    let check = |transport, instrument, trouble| {
        let mock = start(transport);
        let mut ask = user(&mock, instrument);
        ask().unwrap();
        mock.trouble(instrument, trouble);
        let fault = (0..2).find_map(|_| ask().err()).expect("noticed at the second question at the latest");
        let expected = match trouble {
            Trouble::Garbled | Trouble::Truncated | Trouble::Doubled => matches!(fault.kind, FaultKind::Garbled { .. }),
            _ => matches!(fault.kind, FaultKind::Silent { .. }),
        };
        assert!(expected && fault.is_retryable(), "{instrument:?}, {trouble:?}: {fault}");
        mock.trouble(instrument, Trouble::None);
        ask().unwrap_or_else(|fault| panic!("{instrument:?} does not recover from {trouble:?}: {fault}"));
    };
    // In parallel, because most of the time is spent waiting for deadlines.
    std::thread::scope(|scope| {
        for instrument in
            [MockInstrument::CounterS1, MockInstrument::Thermometer, MockInstrument::Stage, MockInstrument::Multimeter]
        {
            for (transport, trouble) in [
                (Transport::Terminal, Trouble::Silent),
                (Transport::Tcp, Trouble::Late),
                (Transport::Terminal, Trouble::Garbled),
                (Transport::Tcp, Trouble::Truncated),
                (Transport::Terminal, Trouble::Doubled),
                (Transport::Tcp, Trouble::Stale),
            ] {
                scope.spawn(move || check(transport, instrument, trouble));
            }
        }
    });
}

#[test]
fn a_pulled_cable_is_named_and_another_unit_is_not_ours() {
    let mock = start(Transport::Tcp);
    for instrument in OTHERS {
        let mut ask = user(&mock, instrument);
        mock.trouble(instrument, Trouble::Unplugged);
        let fault = std::iter::repeat_with(&mut ask).find_map(Result::err).unwrap();
        assert!(matches!(fault.kind, FaultKind::Disconnected { .. }), "{instrument:?}: {fault}");
        mock.trouble(instrument, Trouble::Exchanged);
        let fault = ask().unwrap_err();
        assert!(matches!(fault.kind, FaultKind::WrongInstrument { .. }), "{instrument:?}: {fault}");
        mock.trouble(instrument, Trouble::Refusing);
        let fault = ask().unwrap_err();
        // The stage does not answer a query that it does not execute.
        let silent = instrument == MockInstrument::Stage && matches!(fault.kind, FaultKind::Silent { .. });
        assert!(silent || matches!(fault.kind, FaultKind::Refused { .. }), "{instrument:?}: {fault}");
        mock.trouble(instrument, Trouble::None);
        ask().unwrap();
    }
}

#[test]
fn another_unit_is_named_where_no_cable_was_out() {
    let mock = start(Transport::Terminal);
    let instruments: [(MockInstrument, Box<dyn Instrument>); 5] = [
        (MockInstrument::Multimeter, Box::new(multimeter(&mock))),
        (MockInstrument::CounterS1, Box::new(counter(&mock, MockInstrument::CounterS1))),
        (MockInstrument::CounterS2, Box::new(counter(&mock, MockInstrument::CounterS2))),
        (MockInstrument::Thermometer, Box::new(thermometer(&mock))),
        (MockInstrument::Stage, Box::new(stage(&mock))),
    ];
    for (place, mut instrument) in instruments {
        let known = instrument.identify().unwrap();
        mock.trouble(place, Trouble::Exchanged);
        for _ in 0..2 {
            let fault = instrument.identify().unwrap_err();
            assert!(matches!(fault.kind, FaultKind::WrongInstrument { .. }), "{place:?}: {fault}");
        }
        mock.trouble(place, Trouble::None);
        assert_eq!(instrument.identify().unwrap(), known, "{place:?}");
    }
}

#[test]
fn a_counter_that_lost_its_power_reports_that_positions_do_not_fit() {
    let mock = start(Transport::Terminal);
    let mut counter = counter(&mock, MockInstrument::CounterS2);
    counter.read().unwrap();
    mock.trouble(MockInstrument::CounterS2, Trouble::PowerCycled);
    mock.trouble(MockInstrument::CounterS2, Trouble::None);
    let fault = (0..3).find_map(|_| counter.read().err()).expect("the greeting gives it away");
    let fault = if fault.is_retryable() { counter.read().unwrap_err() } else { fault };
    assert!(fault.to_string().contains("power was interrupted"), "{fault}");
    assert!(counter.read().is_ok(), "usable again");
}

#[test]
fn a_broken_sensor_is_a_fault_and_no_temperature() {
    let mock = start(Transport::Terminal);
    let mut thermometer = thermometer(&mock);
    let read = thermometer.read().unwrap();
    assert!(read.len() == 3 && read.iter().all(|t| (t.0 - 24.0).abs() < 1.0), "{read:?}");
    mock.trouble(MockInstrument::Thermometer, Trouble::Saturated);
    let fault = thermometer.read().unwrap_err();
    assert!(matches!(fault.kind, FaultKind::Saturated { .. }) && !fault.is_retryable(), "{fault}");
    mock.trouble(MockInstrument::Thermometer, Trouble::None);
    thermometer.read().unwrap();
}

#[test]
fn both_encoders_follow_the_shaft_and_differ_by_their_shape_and_delay() {
    let mock = start(Transport::Terminal);
    let mut bench = mock.open_bench("mock").unwrap();
    let (mut s1, mut s2) = (bench.reference_encoder.take().unwrap(), bench.test_encoder.take().unwrap());
    assert!(s2.status().unwrap().periods_are_consistent().unwrap());
    bench.joint.arm(RadPerSec(200.0), Amperes(5.0)).unwrap();
    let mut mean_disparity = |velocity_rad_s: f64| {
        let (mut sum_rad, readings) = (0.0, 400);
        for reading in 0..readings + 50 {
            bench.joint.set_velocity(RadPerSec(velocity_rad_s)).unwrap();
            bench.clock.sleep_until_s(bench.clock.now_s() + 0.0053);
            let disparity_rad = s2.read().unwrap().position.0 - s1.read().unwrap().position.0;
            assert!(disparity_rad.abs() < 0.05, "{disparity_rad} rad apart");
            if reading >= 50 {
                sum_rad += disparity_rad;
            }
        }
        sum_rad / f64::from(readings)
    };
    // The delay of 64.34 µs, and the width of the hysteresis.
    let apart_rad = mean_disparity(-100.0) - mean_disparity(100.0);
    let expected_rad = 2.0 * 100.0 * 64.34e-6;
    assert!((apart_rad - expected_rad).abs() < 6e-4, "{apart_rad} rad, expected {expected_rad} rad");
}

/// Waits on the bench clock until `done`.
fn wait_until(mock: &MockBench, mut done: impl FnMut() -> bool) {
    let clock = mock.clock();
    for _ in 0..200 {
        if done() {
            return;
        }
        clock.sleep_until_s(clock.now_s() + 0.1);
    }
    panic!("not within 20 s");
}

#[test]
fn a_stage_moves_only_when_referenced_and_finds_where_the_encoder_loses_its_periods() {
    let mock = start(Transport::Terminal);
    let (mut stage, mut s2) = (stage(&mock), counter(&mock, MockInstrument::CounterS2));
    let radial = |mm: f64| Pose { shift_m: [1e-3 * mm, 0.0, 0.0], ..Pose::default() };
    let fault = stage.move_to(radial(0.1)).unwrap_err();
    assert!(fault.to_string().contains("not referenced"), "{fault}");
    stage.reference().unwrap();
    let fault = stage.move_to(radial(0.1)).unwrap_err();
    assert!(fault.to_string().contains("busy"), "{fault}");
    wait_until(&mock, || stage.is_referenced().unwrap());
    assert!(stage.move_to(radial(40.0)).unwrap_err().to_string().contains("cannot be reached"));
    // Table 4.4: −0.25 and +0.3 mm.
    for (mm, consistent) in [(0.28, true), (0.32, false), (-0.23, true), (-0.27, false), (0.0, true)] {
        stage.move_to(radial(mm)).unwrap();
        wait_until(&mock, || stage.is_settled().unwrap());
        assert!((stage.pose().unwrap().shift_m[0] - 1e-3 * mm).abs() < 1e-6);
        assert_eq!(s2.periods_are_consistent().unwrap(), consistent, "{mm} mm");
    }
}

#[test]
fn a_stage_stops_at_once_and_reports_a_lost_reference() {
    let mock = start(Transport::Terminal);
    let mut stage = stage(&mock);
    stage.reference().unwrap();
    wait_until(&mock, || stage.is_referenced().unwrap());
    stage.move_to(Pose { shift_m: [0.01, 0.0, 0.0], ..Pose::default() }).unwrap();
    mock.clock().sleep_until_s(mock.clock().now_s() + 1.0);
    stage.stop().unwrap();
    let there = stage.pose().unwrap().shift_m[0];
    mock.clock().sleep_until_s(mock.clock().now_s() + 1.0);
    assert!((0.001..0.003).contains(&there) && (stage.pose().unwrap().shift_m[0] - there).abs() < 1e-6, "{there} m");
    stage.move_to(Pose::default()).unwrap();
    mock.trouble(MockInstrument::Stage, Trouble::PowerCycled);
    assert!(stage.pose().is_err());
    mock.trouble(MockInstrument::Stage, Trouble::None);
    let fault = stage.pose().unwrap_err();
    assert!(fault.to_string().contains("lost their reference"), "{fault}");
}

#[test]
fn an_overloaded_analogue_output_is_a_fault_and_no_torque() {
    let mock = start(Transport::Terminal);
    let mut multimeter = multimeter(&mock);
    assert!(multimeter.read().unwrap().0.abs() < 0.1);
    mock.trouble(MockInstrument::TorqueSensor, Trouble::Saturated);
    let fault = multimeter.read().unwrap_err();
    assert!(matches!(fault.kind, FaultKind::Saturated { .. }) && !fault.is_retryable(), "{fault}");
    mock.trouble(MockInstrument::TorqueSensor, Trouble::None);
    multimeter.read().unwrap();
}
