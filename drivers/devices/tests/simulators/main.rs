//! The drivers with third-party simulators: pymodbus' RTU server, labmcp's Rigol supply and its multimeter. If one is
//! not installed, its test reports that and checks nothing:
//!
//! `pip install pymodbus pyserial labmcp-bench-psu labmcp-scpi`, and `JOINTBENCH_PYTHON` if they are not installed for
//! the `python3` on the path.

use jointbench_devices::driver::{AdamSettings, DmmSettings, ScpiSettings};
use jointbench_devices::{AdamThermometer, DmmTorqueSensor, PortSettings, ScpiSource};
use jointbench_instrument::roles::{CurrentSource, Instrument, Regulation, Thermometer, TorqueSensor};
use jointbench_instrument::units::{Amperes, Volts};
use jointbench_instrument::{Fault, FaultKind};
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/simulators/simulators.py");
/// Output of the script if a simulator is not installed.
const MISSING: &str = "No module named";
const DEADLINE_MS: u64 = 2000;

/// Answers until it is dropped.
struct Simulator {
    program: Child,
    port: PortSettings,
}

impl Simulator {
    /// `None`: the simulator is not installed.
    fn start(words: &[&str], baud: u32) -> Option<Self> {
        let python = std::env::var("JOINTBENCH_PYTHON").unwrap_or_else(|_| "python3".into());
        let mut command = Command::new(&python);
        let program = command.arg(SCRIPT).args(words).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut program = match program {
            Ok(program) => program,
            Err(error) => {
                eprintln!("SKIPPED {words:?}: no {python}: {error}");
                return None;
            }
        };
        let mut line = String::new();
        BufReader::new(program.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        let line = line.trim();
        if line.starts_with('/') || line.starts_with("tcp://") {
            return Some(Self { port: PortSettings::new(line, baud), program });
        }
        let _ended = program.wait();
        assert!(line.starts_with(MISSING), "{words:?}: {line}");
        eprintln!("SKIPPED {words:?}: {line}");
        None
    }
}

impl Drop for Simulator {
    fn drop(&mut self) {
        drop(self.program.stdin.take());
        let _ended = self.program.wait();
    }
}

fn thermometer(simulator: &Simulator, channels: &[u8]) -> Result<AdamThermometer, Fault> {
    AdamThermometer::open(AdamSettings {
        name: "thermometer".into(),
        port: simulator.port.clone(),
        deadline_ms: DEADLINE_MS,
        slave: 1,
        channels: channels.to_vec(),
    })
}

#[test]
fn the_thermometer_on_a_server_of_pymodbus() {
    let Some(adam) = Simulator::start(&["pymodbus", "4015"], 9600) else { return };
    let mut reader = thermometer(&adam, &[0, 1, 2]).unwrap();
    assert_eq!(reader.identify().unwrap().model, "ADAM-4015");
    for _ in 0..20 {
        let temperature_c: Vec<f64> = reader.read().unwrap().iter().map(|temperature| temperature.0).collect();
        let truth_c = [(0x8000, -50.0, 150.0), (0x4000, 0.0, 100.0), (0xC000, -200.0, 200.0)];
        for (temperature_c, (raw, low_c, high_c)) in temperature_c.iter().zip(truth_c) {
            assert!(
                (temperature_c - (low_c + (high_c - low_c) * f64::from(raw) / 65_535.0)).abs() < 1e-9,
                "{temperature_c}"
            );
        }
    }
    drop(reader);
    let broken = thermometer(&adam, &[3]).unwrap().read().unwrap_err();
    assert!(matches!(broken.kind, FaultKind::Saturated { .. }), "{broken}");
}

#[test]
fn another_module_and_one_without_a_name_are_reported() {
    let Some(other) = Simulator::start(&["pymodbus", "4017"], 9600) else { return };
    let Err(fault) = thermometer(&other, &[0]) else { panic!("it was taken for an ADAM-4015") };
    assert!(matches!(fault.kind, FaultKind::WrongInstrument { .. }), "{fault}");
    let Some(nameless) = Simulator::start(&["pymodbus", "none"], 9600) else { return };
    let Err(fault) = thermometer(&nameless, &[0]) else { panic!("it was taken for an ADAM-4015") };
    assert!(fault.to_string().contains("illegal register address"), "{fault}");
}

#[test]
fn the_supply_on_a_rigol_of_labmcp() {
    for transport in ["tcp", "terminal"] {
        let Some(rigol) = Simulator::start(&["rigol", transport], 9600) else { return };
        let settings = ScpiSettings { name: "brake_a".into(), port: rigol.port.clone(), deadline_ms: DEADLINE_MS };
        let mut brake = ScpiSource::open(settings).unwrap();
        assert_eq!(brake.identify().unwrap().model, "DP821");
        brake.prepare(Volts(45.0)).unwrap();
        let reading = brake.read().unwrap();
        assert!(reading.current.0.abs() < 2e-3, "{reading:?}");
        // 100 Ω: 0.25 A need 25 V, and 0.6 A would exceed the voltage limit.
        for (asked_a, volts, regulation) in
            [(0.25, 25.0, Regulation::ConstantCurrent), (0.6, 45.0, Regulation::ConstantVoltage)]
        {
            brake.set_current(Amperes(asked_a)).unwrap();
            let reading = brake.read().unwrap();
            assert_eq!(reading.regulation, regulation, "{transport}, {asked_a} A: {reading:?}");
            assert!((reading.voltage.0 - volts).abs() < 5e-3, "{transport}, {asked_a} A: {reading:?}");
            assert!((reading.current.0 - volts / 100.0).abs() < 2e-3, "{transport}, {asked_a} A: {reading:?}");
        }
        // A current beyond the limit is refused, and the present current is kept.
        let refused = brake.set_current(Amperes(5.0)).unwrap_err();
        assert!(matches!(refused.kind, FaultKind::Refused { .. }), "{refused}");
        assert!((brake.read().unwrap().current.0 - 0.45).abs() < 2e-3);
        brake.output_off().unwrap();
        let reading = brake.read().unwrap();
        assert_eq!((reading.regulation, reading.current.0), (Regulation::Off, 0.0));
    }
}

#[test]
fn the_torque_on_a_multimeter_of_labmcp() {
    for (transport, volts, torque_nm) in [("tcp", "4.5", Some(9.0)), ("terminal", "2", Some(4.0)), ("tcp", "12", None)]
    {
        let Some(meter) = Simulator::start(&["multimeter", transport, volts], 9600) else { return };
        let (name, port, deadline_ms) = ("torque_sensor".into(), meter.port.clone(), DEADLINE_MS);
        let mut sensor = DmmTorqueSensor::open(DmmSettings { name, port, deadline_ms, nominal_nm: 20.0 }).unwrap();
        assert_eq!(sensor.identify().unwrap().model, "SIM-DMM-PSU");
        // The supply of the multimeter takes a while to reach its voltage.
        std::thread::sleep(std::time::Duration::from_millis(300));
        match (sensor.read(), torque_nm) {
            (Ok(torque), Some(torque_nm)) => assert!((torque.0 - torque_nm).abs() < 1e-3, "{torque:?}"),
            (Err(beyond), None) => assert!(matches!(beyond.kind, FaultKind::Saturated { .. }), "{beyond}"),
            (read, _) => panic!("{volts} V: {read:?}"),
        }
    }
}
