//! Ports that may be opened, and ports that may not.

use jointbench_devices::sim::{MockInstrument, Transport};
use jointbench_devices::transport::{Address, ports, why_closed};
use jointbench_devices::{Joint, MockBench, MockSettings, PortSettings, ScpiSettings, ScpiSource};

#[cfg(target_os = "linux")]
#[test]
fn a_port_that_is_in_use_or_gone_is_reported() {
    let settings = MockSettings { transport: Transport::Terminal, ..MockSettings::new(Joint::JointA, 1) };
    let mock = MockBench::start(settings).unwrap();
    let Address::Serial(path) = mock.address(MockInstrument::Brake).unwrap() else { panic!("a terminal") };
    let why = why_closed(&path).expect("the simulator itself has it open");
    assert!(why.contains("in use by") && why.contains(&std::process::id().to_string()), "{why}");
    assert!(why_closed("/dev/ttyNOWHERE").unwrap().contains("not found"));
    let free = tempfile::NamedTempFile::new().unwrap().into_temp_path();
    assert_eq!(why_closed(free.to_str().unwrap()), None);
}

#[test]
fn every_port_has_an_address_that_opens_it() {
    let found = ports().unwrap();
    assert!(found.iter().all(|port| matches!(&port.address, Address::Serial(path) if !path.is_empty())), "{found:?}");
    assert!(found.is_sorted_by(|a, b| a.address.to_string() <= b.address.to_string()), "{found:?}");
}

#[test]
fn a_serial_number_that_is_not_plugged_in_is_named() {
    let port = PortSettings::new("usb://0000-NOBODY", 115_200);
    let opened = ScpiSource::open(ScpiSettings { name: "brake_a".into(), port, deadline_ms: 100 });
    let fault = opened.map(drop).unwrap_err();
    assert!(
        fault.to_string().contains("0000-NOBODY") && fault.to_string().contains("check that it is connected"),
        "{fault}"
    );
}
