//! The other dialects of the brake's supply, with the same driver.

use jointbench_devices::sim::{MockInstrument, Supply, Trouble};
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::roles::{CurrentSource, Regulation};
use jointbench_instrument::units::{Amperes, Volts};

fn regulates_up_to_its_voltage_limit(brake: &mut dyn CurrentSource, settle: &dyn Fn()) {
    brake.prepare(Volts(30.0)).unwrap();
    brake.set_current(Amperes(0.3)).unwrap();
    settle();
    let reading = brake.read().unwrap();
    assert_eq!(reading.regulation, Regulation::ConstantCurrent);
    assert!((reading.current.0 - 0.3).abs() < 2e-3 && (reading.voltage.0 - 15.6).abs() < 0.5, "{reading:?}");
    // 0.6 A through 52 Ω need 31.2 V.
    brake.set_current(Amperes(0.6)).unwrap();
    settle();
    assert_eq!(brake.read().unwrap().regulation, Regulation::ConstantVoltage);
}

fn reports_lost_mains_power(mock: &MockBench, brake: &mut dyn CurrentSource) {
    mock.trouble(MockInstrument::Brake, Trouble::PowerCycled);
    assert!(brake.read().is_err());
    mock.trouble(MockInstrument::Brake, Trouble::None);
    let fault = (0..2).find_map(|_| brake.read().err()).expect("the output went off by itself");
    assert!(fault.to_string().contains("mains power of the supply was interrupted"), "{fault}");
}

#[test]
fn an_hmp_feeds_the_brake_as_far_as_its_voltage_goes() {
    let mock =
        MockBench::start(MockSettings { supply: Supply::Hmp4040, ..MockSettings::new(Joint::JointA, 2) }).unwrap();
    let mut bench = mock.open_bench("mock").unwrap();
    let brake = bench.brake.as_mut().unwrap();
    assert_eq!(brake.identify().unwrap().model, "HMP4040");
    let clock = mock.clock();
    let settle = || clock.sleep_until_s(clock.now_s() + 1.0);

    let fault = brake.prepare(Volts(45.0)).unwrap_err();
    assert!(fault.to_string().contains("out of range"), "{fault}");
    assert_eq!(brake.read().unwrap().regulation, Regulation::Off);
    regulates_up_to_its_voltage_limit(brake.as_mut(), &settle);

    reports_lost_mains_power(&mock, brake.as_mut());
    brake.prepare(Volts(30.0)).unwrap();
    brake.output_off().unwrap();
    settle();
    assert_eq!(brake.read().unwrap().regulation, Regulation::Off);
}

#[test]
fn a_kepco_regulates_the_current_and_is_off_in_the_safe_state() {
    let mock =
        MockBench::start(MockSettings { supply: Supply::KepcoBop, ..MockSettings::new(Joint::JointA, 2) }).unwrap();
    let mut bench = mock.open_bench("mock").unwrap();
    let brake = bench.brake.as_mut().unwrap();
    let identity = brake.identify().unwrap();
    assert_eq!((identity.maker.as_str(), identity.model.as_str()), ("KEPCO", "BOP 100-2"));
    let clock = mock.clock();
    let settle = || clock.sleep_until_s(clock.now_s() + 1.0);

    // A run may begin with the safe state, before the supply is prepared.
    brake.output_off().unwrap();
    assert_eq!(brake.read().unwrap().regulation, Regulation::Off);
    let fault = brake.prepare(Volts(120.0)).unwrap_err();
    assert!(fault.to_string().contains("out of range"), "{fault}");
    regulates_up_to_its_voltage_limit(brake.as_mut(), &settle);

    brake.output_off().unwrap();
    settle();
    let reading = brake.read().unwrap();
    assert_eq!((reading.regulation, reading.current.0), (Regulation::Off, 0.0));
    brake.prepare(Volts(30.0)).unwrap();
    reports_lost_mains_power(&mock, brake.as_mut());
}
