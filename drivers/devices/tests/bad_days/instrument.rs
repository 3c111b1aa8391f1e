//! Troubles of the instruments and of the plant.

use super::{ask, settings, start};
use jointbench_devices::driver::{LorenzSettings, Range};
use jointbench_devices::sim::{MockInstrument, PlannedTrouble, Transport, Trouble};
use jointbench_devices::{LorenzSensor, MockBench, MockSettings, PortSettings};
use jointbench_instrument::roles::{Instrument, Regulation, TorqueSensor};
use jointbench_instrument::units::{Amperes, RadPerSec};
use jointbench_instrument::{Bench, Fault, FaultKind};

fn wait(bench: &Bench, seconds: f64) {
    bench.clock.sleep_until_s(bench.clock.now_s() + seconds);
}

fn name(bench: &mut Bench, instrument: MockInstrument) -> String {
    let named: &mut dyn Instrument = match instrument {
        MockInstrument::TorqueSensor => bench.torque_sensor.as_mut().unwrap().as_mut(),
        MockInstrument::Brake => bench.brake.as_mut().unwrap().as_mut(),
        _ => bench.joint.as_mut(),
    };
    named.name().to_owned()
}

fn check_reported(result: Result<(), Fault>, text: &str) {
    let fault = result.expect_err(text);
    assert!(matches!(fault.kind, FaultKind::Reported { .. }) && !fault.is_retryable(), "{fault}");
    assert!(fault.to_string().contains(text), "{fault}");
}

#[test]
fn a_drive_that_lost_its_state_gives_no_reading_before_that_is_reported() {
    let (mock, mut bench) = start(Transport::Terminal);
    bench.joint.set_velocity(RadPerSec(30.0)).unwrap();
    wait(&bench, 0.2);
    assert!(bench.joint.read().unwrap().motor_position.0 > 1.0);
    mock.trouble(MockInstrument::Joint, Trouble::PowerCycled);
    for _ in 0..2 {
        let fault = bench.joint.read().unwrap_err();
        assert!(matches!(fault.kind, FaultKind::Silent { .. }), "{fault}");
    }
    mock.trouble(MockInstrument::Joint, Trouble::None);
    // The drive boots for a second and is silent meanwhile.
    wait(&bench, 1.5);
    check_reported(bench.joint.read().map(drop), "disarmed");
    assert!(!bench.joint.health().unwrap().armed);
    assert!(bench.joint.read().unwrap().motor_position.0.abs() < 0.5, "counts from where it was at power-up");
    bench.joint.arm(RadPerSec(100.0), Amperes(5.0)).unwrap();
    assert!(bench.joint.health().unwrap().armed, "usable again");
}

#[test]
fn a_supply_that_lost_its_state_is_reported() {
    let (mock, mut bench) = start(Transport::Tcp);
    let brake = bench.brake.as_mut().unwrap();
    brake.set_current(Amperes(0.3)).unwrap();
    mock.trouble(MockInstrument::Brake, Trouble::PowerCycled);
    let fault = brake.read().unwrap_err();
    assert!(matches!(fault.kind, FaultKind::Silent { .. }), "{fault}");
    mock.trouble(MockInstrument::Brake, Trouble::None);
    check_reported(ask(&mut bench, MockInstrument::Brake), "without a command");
    let reading = bench.brake.as_mut().unwrap().read().unwrap();
    assert_eq!(reading.regulation, Regulation::Off, "{reading:?}");

    // Too short to miss a request: the reading itself shows the power cycle.
    let (mock, mut bench) = start(Transport::Terminal);
    mock.trouble(MockInstrument::Brake, Trouble::PowerCycled);
    mock.trouble(MockInstrument::Brake, Trouble::None);
    check_reported(ask(&mut bench, MockInstrument::Brake), "without a command");
}

#[test]
fn another_unit_of_the_same_model_is_not_ours() {
    let (mock, mut bench) = start(Transport::Tcp);
    for instrument in MockInstrument::JOINT_BENCH {
        mock.trouble(instrument, Trouble::Unplugged);
        while ask(&mut bench, instrument).is_ok() {}
        mock.trouble(instrument, Trouble::Exchanged);
        for _ in 0..2 {
            let fault = ask(&mut bench, instrument).unwrap_err();
            assert!(matches!(fault.kind, FaultKind::WrongInstrument { .. }), "{instrument:?}: {fault}");
        }
        mock.trouble(instrument, Trouble::None);
        ask(&mut bench, instrument).unwrap();
    }
}

#[test]
fn another_unit_is_named_where_no_cable_was_out() {
    let (mock, mut bench) = start(Transport::Terminal);
    for instrument in MockInstrument::JOINT_BENCH {
        let name = name(&mut bench, instrument);
        let known = bench.instrument(&name).unwrap().identify().unwrap();
        mock.trouble(instrument, Trouble::Exchanged);
        let fault = bench.instrument(&name).unwrap().identify().unwrap_err();
        let FaultKind::WrongInstrument { expected, found } = &fault.kind else { panic!("{instrument:?}: {fault}") };
        assert!(expected.contains(&known.serial) && !found.contains(&known.serial), "{instrument:?}: {fault}");
        let again = ask(&mut bench, instrument).unwrap_err();
        assert_eq!(again.kind, fault.kind, "{instrument:?} gives no reading");
        mock.trouble(instrument, Trouble::None);
        ask(&mut bench, instrument).unwrap();
        assert_eq!(bench.instrument(&name).unwrap().identify().unwrap(), known);
    }
}

#[test]
fn a_supply_that_is_exchanged_for_one_just_switched_on_is_another_supply() {
    let (mock, mut bench) = start(Transport::Terminal);
    mock.trouble(MockInstrument::Brake, Trouble::PowerCycled);
    mock.trouble(MockInstrument::Brake, Trouble::Exchanged);
    let fault = ask(&mut bench, MockInstrument::Brake).unwrap_err();
    assert!(matches!(fault.kind, FaultKind::WrongInstrument { .. }), "{fault}");
}

#[test]
fn another_supply_is_switched_off_all_the_same() {
    let (mock, mut bench) = start(Transport::Terminal);
    let brake = bench.brake.as_mut().unwrap();
    brake.set_current(Amperes(0.3)).unwrap();
    mock.trouble(MockInstrument::Brake, Trouble::Exchanged);
    brake.identify().unwrap_err();
    brake.output_off().unwrap();
    assert!(matches!(brake.read().unwrap_err().kind, FaultKind::WrongInstrument { .. }), "its readings are not ours");
    mock.trouble(MockInstrument::Brake, Trouble::None);
    assert_eq!(brake.read().unwrap().regulation, Regulation::Off);
}

#[test]
fn an_instrument_that_refuses_everything_gives_no_reading() {
    let (mock, mut bench) = start(Transport::Terminal);
    for instrument in MockInstrument::JOINT_BENCH {
        mock.trouble(instrument, Trouble::Refusing);
        let fault = ask(&mut bench, instrument).unwrap_err();
        match instrument {
            MockInstrument::Joint => assert!(fault.to_string().contains("unknown command"), "{fault}"),
            MockInstrument::TorqueSensor => assert!(fault.to_string().contains("rotor: not found"), "{fault}"),
            // A query that cannot be executed is never answered.
            _ => assert!(matches!(fault.kind, FaultKind::Silent { .. }), "{fault}"),
        }
        assert!(ask(&mut bench, instrument).is_err(), "{instrument:?} still refuses");
        mock.trouble(instrument, Trouble::None);
        ask(&mut bench, instrument).unwrap_or_else(|fault| panic!("{instrument:?} does not recover: {fault}"));
    }
    mock.trouble(MockInstrument::Brake, Trouble::Refusing);
    let fault = bench.brake.as_mut().unwrap().set_current(Amperes(0.1)).unwrap_err();
    assert!(matches!(&fault.kind, FaultKind::Refused { what } if what.contains("-200")), "{fault}");
}

#[test]
fn a_supply_out_of_voltage_reports_that_it_does_not_hold_the_current() {
    let (mock, mut bench) = start(Transport::Terminal);
    bench.brake.as_mut().unwrap().set_current(Amperes(0.4)).unwrap();
    let mut settled = |trouble| {
        mock.trouble(MockInstrument::Brake, trouble);
        wait(&bench, 1.0);
        bench.brake.as_mut().unwrap().read().unwrap()
    };
    let held = settled(Trouble::None);
    assert!(held.regulation == Regulation::ConstantCurrent && (held.current.0 - 0.4).abs() < 2e-3, "{held:?}");
    let lost = settled(Trouble::CurrentLost);
    assert!(lost.regulation == Regulation::ConstantVoltage && lost.current.0 < 0.2, "{lost:?}");
    assert!((lost.voltage.0 - 45.0).abs() < 0.1, "{lost:?}");
    assert_eq!(settled(Trouble::None).regulation, Regulation::ConstantCurrent);
}

#[test]
fn a_hot_joint_is_seen() {
    let (mock, mut bench) = start(Transport::Terminal);
    let limit_c = bench.limits.temperature_c;
    let mut temperature_c = || bench.joint.health().unwrap().temperature.unwrap().0;
    assert!(temperature_c() < 40.0);
    mock.trouble(MockInstrument::Joint, Trouble::OverTemperature);
    assert!(temperature_c() > limit_c);
    mock.trouble(MockInstrument::Joint, Trouble::None);
    assert!(temperature_c() < 40.0);
}

#[test]
fn a_saturated_range_is_a_fault_and_the_larger_one_a_number() {
    for (range, nominal_nm) in [(Range::Fine, 20.0), (Range::Coarse, 200.0)] {
        let mock = MockBench::start(settings(Transport::Terminal)).unwrap();
        let port = PortSettings::new(mock.address(MockInstrument::TorqueSensor).unwrap(), 230_400);
        let sensor = LorenzSettings { name: "torque".into(), port, deadline_ms: 400, range, nominal_nm };
        let mut sensor = LorenzSensor::open(sensor).unwrap();
        mock.trouble(MockInstrument::TorqueSensor, Trouble::Saturated);
        match (range, sensor.read()) {
            (Range::Coarse, Ok(torque)) => assert!((torque.0 - 27.0).abs() < 0.2, "{torque}"),
            (Range::Fine, Err(fault)) => {
                assert!(matches!(fault.kind, FaultKind::Saturated { .. }) && !fault.is_retryable(), "{fault}");
            }
            (_, other) => panic!("{range:?}: {other:?}"),
        }
        mock.trouble(MockInstrument::TorqueSensor, Trouble::None);
        assert!(sensor.read().unwrap().0.abs() < 0.2);
    }
}

#[test]
fn a_planned_trouble_comes_and_goes_by_itself() {
    let planned = PlannedTrouble {
        instrument: MockInstrument::TorqueSensor,
        trouble: Trouble::Silent,
        from_s: 0.5,
        until_s: Some(0.6),
    };
    let mock = MockBench::start(MockSettings { troubles: vec![planned], ..settings(Transport::Terminal) }).unwrap();
    let mut bench = mock.open_bench("mock").unwrap();
    let answers = [0.4, 0.55, 0.7].map(|at_s| {
        bench.clock.sleep_until_s(at_s);
        ask(&mut bench, MockInstrument::TorqueSensor).is_ok()
    });
    assert_eq!(answers, [true, false, true]);
}
