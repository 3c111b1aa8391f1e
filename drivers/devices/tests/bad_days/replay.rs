//! Repeats a recorded conversation with an instrument that only has the record.

use super::{DEADLINE, start};
use jointbench_devices::driver::{LorenzSettings, Range};
use jointbench_devices::sim::{MockInstrument, Replay, Transport, Trouble};
use jointbench_devices::transport::{Address, Traffic};
use jointbench_devices::{LorenzSensor, MockBench, PortSettings, ScpiSettings, ScpiSource};
use jointbench_instrument::roles::{CurrentSource, SupplyReading, TorqueSensor};
use jointbench_instrument::units::{Amperes, Volts};
use jointbench_instrument::{Fault, FaultKind};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// A conversation with a silent supply in the middle.
fn day(address: Address, record: Option<PathBuf>, mock: Option<&MockBench>) -> (Vec<SupplyReading>, Fault) {
    let trouble = |trouble| {
        if let Some(mock) = mock {
            mock.trouble(MockInstrument::Brake, trouble);
        }
    };
    let port = PortSettings { record, ..PortSettings::new(address, 115_200) };
    let deadline_ms = DEADLINE.as_millis() as u64;
    let mut brake = ScpiSource::open(ScpiSettings { name: "brake_a".into(), port, deadline_ms }).unwrap();
    brake.prepare(Volts(45.0)).unwrap();
    brake.set_current(Amperes(0.3)).unwrap();
    let mut readings = vec![brake.read().unwrap()];
    trouble(Trouble::Silent);
    let fault = brake.read().unwrap_err();
    trouble(Trouble::None);
    readings.push(brake.read().unwrap());
    (readings, fault)
}

#[test]
fn a_bad_day_can_be_had_again() {
    let folder = tempfile::tempdir().unwrap();
    for transport in [Transport::Terminal, Transport::Tcp] {
        let (mock, bench) = start(transport);
        let address = mock.address(MockInstrument::Brake).unwrap();
        drop(bench);
        let file = folder.path().join("brake.txt");
        let recorded = day(address, Some(file.clone()), Some(&mock));
        assert!(matches!(recorded.1.kind, FaultKind::Silent { .. }), "{}", recorded.1);

        let traffic = Traffic::parse(&std::fs::read_to_string(&file).unwrap()).unwrap();
        let replay = Replay::start(traffic, transport).unwrap();
        let replayed = day(replay.address().clone(), None, None);
        assert_eq!((replayed.0, replayed.1.kind), (recorded.0, recorded.1.kind));
        assert_eq!(replay.departure(), None);
        until_done(&replay);
    }
}

/// The last message of a driver may still be in transit.
fn until_done(replay: &Replay) {
    let asked = Instant::now();
    while !replay.is_done() && asked.elapsed() < DEADLINE {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(replay.is_done());
}

#[test]
fn another_question_than_the_recorded_one_is_named_and_not_answered() {
    let traffic = Traffic::parse("0.0 > 0A 2A 43 4C 53 0A\n0.1 > 2A 4F 50 43 3F 0A\n0.2 < 31 0A\n").unwrap();
    let replay = Replay::start(traffic, Transport::Tcp).unwrap();
    let port = PortSettings::new(replay.address().clone(), 115_200);
    let opened = ScpiSource::open(ScpiSettings { name: "brake_a".into(), port, deadline_ms: 200 });
    assert!(matches!(opened.map(drop).unwrap_err().kind, FaultKind::Silent { .. }));
    let departure = replay.departure().unwrap();
    assert!(departure.contains("expected `*OPC?") && departure.contains("heard `*IDN?"), "{departure}");
}

#[test]
fn a_lost_port_is_lost_again_and_a_record_that_cannot_be_written_is_reported() {
    let replay =
        Replay::start(Traffic::parse("0.0 > 0A 2A 43 4C 53 0A\n0.1 ! lost\n").unwrap(), Transport::Tcp).unwrap();
    let mut port = PortSettings::new(replay.address().clone(), 115_200);
    let open = |port| ScpiSource::open(ScpiSettings { name: "brake_a".into(), port, deadline_ms: 400 }).map(drop);
    let fault = open(port.clone()).unwrap_err();
    assert!(matches!(fault.kind, FaultKind::Disconnected { .. }), "{fault}");

    let (mock, bench) = start(Transport::Tcp);
    port.address = mock.address(MockInstrument::Brake).unwrap();
    port.record = Some(PathBuf::from("/nowhere/at/all.txt"));
    drop(bench);
    assert!(open(port).unwrap_err().to_string().contains("/nowhere/at/all.txt"));
}

#[test]
fn any_stretch_of_a_bench_can_be_recorded_and_had_again() {
    let folder = tempfile::tempdir().unwrap();
    let (_mock, mut bench) = start(Transport::Terminal);
    bench.joint.read().unwrap();
    let files = bench.record(Some(folder.path())).unwrap();
    let sensor = bench.torque_sensor.as_mut().unwrap();
    let recorded = [sensor.read().unwrap(), sensor.read().unwrap()];
    bench.record(None).unwrap();
    bench.torque_sensor.as_mut().unwrap().read().unwrap();
    let names: Vec<_> = files.iter().map(|file| file.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["joint.traffic", "torque_sensor.traffic", "brake_a.traffic"]);

    let traffic = Traffic::parse(&std::fs::read_to_string(&files[1]).unwrap()).unwrap();
    let replay = Replay::start(traffic, Transport::Terminal).unwrap();
    let port = PortSettings::new(replay.address().clone(), 230_400);
    let deadline_ms = DEADLINE.as_millis() as u64;
    let settings = LorenzSettings { name: "torque".into(), port, deadline_ms, range: Range::Fine, nominal_nm: 20.0 };
    let mut sensor = LorenzSensor::open(settings).unwrap();
    assert_eq!([sensor.read().unwrap(), sensor.read().unwrap()], recorded);
    until_done(&replay);
    assert_eq!(replay.departure(), None);

    let fault = bench.record(Some(&folder.path().join("nowhere"))).unwrap_err();
    assert!(fault.to_string().contains("nowhere"), "{fault}");
}
