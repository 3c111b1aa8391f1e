//! Drivers with failing instruments: the right fault, no invented sample, a link that recovers.

mod cable;
mod instrument;
mod others;
mod replay;
mod stream;

use jointbench_devices::sim::{MockInstrument, Transport};
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::units::{Amperes, RadPerSec, Volts};
use jointbench_instrument::{Bench, Fault};
use std::time::Duration;

const DEADLINE: Duration = Duration::from_millis(400);

fn settings(transport: Transport) -> MockSettings {
    let deadline_ms = DEADLINE.as_millis() as u64;
    MockSettings { transport, deadline_ms, ..MockSettings::new(Joint::JointA, 4) }
}

fn start(transport: Transport) -> (MockBench, Bench) {
    let mock = MockBench::start(settings(transport)).unwrap();
    let mut bench = mock.open_bench("mock").unwrap();
    bench.joint.arm(RadPerSec(100.0), Amperes(5.0)).unwrap();
    bench.brake.as_mut().unwrap().prepare(Volts(45.0)).unwrap();
    (mock, bench)
}

/// A use of an instrument that needs a reply.
fn ask(bench: &mut Bench, instrument: MockInstrument) -> Result<(), Fault> {
    match instrument {
        MockInstrument::Joint => bench.joint.read().map(drop),
        MockInstrument::TorqueSensor => bench.torque_sensor.as_mut().unwrap().read().map(drop),
        MockInstrument::Brake => bench.brake.as_mut().unwrap().read().map(drop),
        other => panic!("{other:?} is not of the joint bench"),
    }
}
