//! Opens the instruments of a description. Simulation swaps the wire, not the driver.

use crate::config::{BenchDescription, Hardware, Source};
use crate::view::{Instrument, InstrumentIdentity};
use jointbench_devices::driver::{LorenzSettings, OdriveSettings, ScpiSettings, Thermistor};
use jointbench_devices::{LorenzSensor, MockBench, OdriveJoint, PortSettings, ScpiSource};
use jointbench_instrument::roles::{self, CurrentSource, Identity, TorqueSensor};
use jointbench_instrument::{Bench, Clock, Fault, SystemClock};
use std::sync::Arc;

/// Simulated instruments share the machine with everything else.
const MOCK_DEADLINE_MS: u64 = 3000;

/// What opening has brought: the instruments one by one, and the bench where all of them answer.
pub struct Opened {
    pub instruments: Vec<Instrument>,
    pub bench: Option<Bench>,
    /// Answers for as long as it is held.
    _mock: Option<MockBench>,
}

/// Opens and identifies every instrument. Nothing is commanded. A fault is data here, and stands beside its instrument.
pub fn open(description: &BenchDescription) -> Opened {
    match &description.source {
        Source::Hardware(hardware) => {
            let (bench, instruments) = wire(description, hardware, Arc::new(SystemClock::start()));
            Opened { instruments, bench, _mock: None }
        }
        Source::Mock(settings) => match MockBench::start(settings.clone()) {
            Ok(mock) => {
                let (bench, instruments) = wire(description, &simulated(&mock), mock.clock());
                Opened { instruments, bench, _mock: Some(mock) }
            }
            Err(fault) => {
                let mut found = slot(description, "joint", "joint", "mock", String::new());
                found.fault = Some(fault.to_string());
                Opened { instruments: vec![found], bench: None, _mock: None }
            }
        },
    }
}

fn simulated(mock: &MockBench) -> Hardware {
    let ports = mock.ports();
    let (range, nominal_nm) = mock.settings().torque_range();
    Hardware {
        joint: OdriveSettings {
            name: "joint".into(),
            port: PortSettings::new(ports.joint, 921_600),
            deadline_ms: MOCK_DEADLINE_MS,
            link_encoder: true,
            thermistor: Some(Thermistor::Motor),
        },
        torque_sensor: Some(LorenzSettings {
            name: "torque_sensor".into(),
            port: PortSettings::new(ports.torque_sensor, 230_400),
            deadline_ms: MOCK_DEADLINE_MS,
            range,
            nominal_nm,
        }),
        brake: Some(ScpiSettings {
            name: "brake_a".into(),
            port: PortSettings::new(ports.brake, 115_200),
            deadline_ms: MOCK_DEADLINE_MS,
        }),
    }
}

fn wire(
    description: &BenchDescription,
    hardware: &Hardware,
    clock: Arc<dyn Clock>,
) -> (Option<Bench>, Vec<Instrument>) {
    let mut slots = Vec::new();
    let settings = hardware.joint.clone();
    let found = slot(description, "joint", &settings.name, "odrive", settings.port.address.to_string());
    let joint = OdriveJoint::open(settings, clock.clone());
    let joint = keep(found, joint, &mut slots);
    let torque_sensor = hardware.torque_sensor.clone().map(|settings| {
        let port = settings.port.address.to_string();
        let found = slot(description, "torque_sensor", &settings.name, "lorenz", port);
        let sensor = LorenzSensor::open(settings);
        keep(found, sensor, &mut slots)
    });
    let brake = hardware.brake.clone().map(|settings| {
        let found = slot(description, "brake", &settings.name, "scpi", settings.port.address.to_string());
        let source = ScpiSource::open(settings);
        keep(found, source, &mut slots)
    });
    let all_ready = slots.iter().all(|slot| slot.ready);
    let bench = joint.filter(|_| all_ready).map(|joint| Bench {
        name: description.name.clone(),
        simulated: description.is_simulated(),
        clock,
        limits: description.limits,
        constants: description.constants,
        joint,
        torque_sensor: torque_sensor.flatten().map(|sensor| sensor as Box<dyn TorqueSensor>),
        brake: brake.flatten().map(|source| source as Box<dyn CurrentSource>),
    });
    (bench, slots)
}

/// One instrument as people see it, before it is opened.
fn slot(description: &BenchDescription, role: &str, name: &str, driver: &str, port: String) -> Instrument {
    Instrument {
        bench: description.name.clone(),
        role: role.to_owned(),
        name: name.to_owned(),
        driver: driver.to_owned(),
        port,
        ready: false,
        identity: None,
        fault: None,
    }
}

fn keep<T: roles::Instrument>(
    mut slot: Instrument,
    opened: Result<T, Fault>,
    slots: &mut Vec<Instrument>,
) -> Option<Box<T>> {
    let opened = opened.and_then(|mut instrument| Ok((instrument.identify()?, Box::new(instrument))));
    let instrument = match opened {
        Ok((identity, instrument)) => {
            slot.ready = true;
            slot.identity = Some(identity.into());
            Some(instrument)
        }
        Err(fault) => {
            slot.fault = Some(fault.to_string());
            None
        }
    };
    slots.push(slot);
    instrument
}

impl From<Identity> for InstrumentIdentity {
    fn from(identity: Identity) -> Self {
        Self { maker: identity.maker, model: identity.model, serial: identity.serial, firmware: identity.firmware }
    }
}
