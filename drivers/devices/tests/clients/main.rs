//! The mock bench's instruments with third-party clients: PI's PIPython, LorenzTelegram, pymeasure, minimalmodbus and
//! pymodbus. If a client is not installed, its test reports that and checks nothing:
//!
//! `pip install pipython LorenzTelegram pymeasure pyvisa-py minimalmodbus pymodbus`, and `JOINTBENCH_PYTHON` if they
//! are not installed for the `python3` on the path.

use jointbench_devices::sim::{MockInstrument, Supply, Transport};
use jointbench_devices::{Joint, MockBench, MockSettings};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/clients/clients.py");
/// Exit code of the script if a client is not installed.
const MISSING: i32 = 77;

/// `pace`: bench seconds per second of the client.
fn check(client: &str, instrument: MockInstrument, transport: Transport, pace: f64) {
    let joint = match instrument {
        MockInstrument::Stage | MockInstrument::Thermometer => Joint::EncoderShaft,
        _ => Joint::JointA,
    };
    let settings = MockSettings {
        transport,
        pace: Some(pace),
        supply: match client {
            "pymeasure_hmp4040" => Supply::Hmp4040,
            "pymeasure_kepco" => Supply::KepcoBop,
            _ => Supply::Dp821a,
        },
        ..MockSettings::new(joint, 1)
    };
    let mock = MockBench::start(settings).unwrap();
    let address = mock.address(instrument).unwrap().to_string();
    let (clock, ended) = (mock.clock(), AtomicBool::new(false));
    let python = std::env::var("JOINTBENCH_PYTHON").unwrap_or_else(|_| "python3".into());
    let outcome = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !ended.load(Ordering::Acquire) {
                clock.sleep_until_s(clock.now_s() + 0.02);
            }
        });
        let outcome = Command::new(&python).args([SCRIPT, client, &address]).output();
        ended.store(true, Ordering::Release);
        outcome
    });
    let output = match outcome {
        Ok(output) if output.status.code() != Some(MISSING) => output,
        Ok(output) => return eprintln!("SKIPPED {client}: {}", String::from_utf8_lossy(&output.stdout).trim()),
        Err(error) => return eprintln!("SKIPPED {client}: no {python}: {error}"),
    };
    let text = [output.stdout, output.stderr].concat();
    assert!(output.status.success(), "{client} over {transport:?}: {}", String::from_utf8_lossy(&text));
    // A terminal is released a moment after its client has ended.
    std::thread::sleep(Duration::from_millis(50));
}

#[test]
fn pipython_references_and_moves_the_stage() {
    for transport in [Transport::Tcp, Transport::Terminal] {
        check("pipython", MockInstrument::Stage, transport, 10.0);
    }
}

#[test]
fn lorenz_telegram_asks_reads_blocks_and_streams() {
    check("lorenz", MockInstrument::TorqueSensor, Transport::Terminal, 1.0);
}

#[test]
fn modbus_clients_read_the_thermometer_and_hear_what_is_refused() {
    check("minimalmodbus", MockInstrument::Thermometer, Transport::Terminal, 1.0);
    check("pymodbus", MockInstrument::Thermometer, Transport::Terminal, 1.0);
    check("pymodbus", MockInstrument::Thermometer, Transport::Tcp, 1.0);
}

#[test]
fn pymeasure_and_pyvisa_set_and_measure_the_supplies() {
    check("pymeasure_hmp4040", MockInstrument::Brake, Transport::Tcp, 1.0);
    check("pymeasure_kepco", MockInstrument::Brake, Transport::Tcp, 1.0);
    check("pyvisa_dp821a", MockInstrument::Brake, Transport::Tcp, 1.0);
    check("pyvisa_dp821a", MockInstrument::Brake, Transport::Terminal, 1.0);
}

#[test]
fn qcodes_drives_the_dp821a() {
    check("qcodes_dp821", MockInstrument::Brake, Transport::Tcp, 1.0);
}
