//! The mock bench as its owner sees it.

use super::clock::SteppedClock;
use super::data_sheet::{Joint, Load};
use super::firmware::Odrive;
use super::plant::{HIDDEN_EFFECTS, Hidden, Plant, Truth};
#[cfg(unix)]
use super::port::serve_terminal;
use super::port::{Port, lock, serve_tcp};
use super::rig::{MockInstrument, Rig};
use super::trouble::{PlannedTrouble, Trouble};
use crate::driver::{
    LorenzSensor, LorenzSettings, OdriveJoint, OdriveSettings, Range, ScpiSettings, ScpiSource, Thermistor,
};
use crate::transport::{Address, PortSettings};
use jointbench_instrument::{Bench, Clock, Fault};
use std::io;
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

/// Generous: other programs share the machine with a simulated instrument.
const DEADLINE_MS: u64 = 3000;

/// What the instruments' wires are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transport {
    /// Pseudo-terminals; loopback TCP on systems that have none.
    Terminal,
    Tcp,
}

#[derive(Debug, Clone)]
pub struct MockSettings {
    pub joint: Joint,
    pub load: Load,
    pub seed: u64,
    /// Names out of [`HIDDEN_EFFECTS`].
    pub effects: Vec<String>,
    /// Bench seconds for each second of wall time. `None`: as fast as it goes.
    pub pace: Option<f64>,
    pub transport: Transport,
    /// For the drivers that [`MockBench::open_bench`] opens.
    pub deadline_ms: u64,
    pub troubles: Vec<PlannedTrouble>,
    /// Beyond joint, torque sensor and brake.
    pub others: Vec<MockInstrument>,
}

impl MockSettings {
    pub fn new(joint: Joint, seed: u64) -> Self {
        Self {
            joint,
            load: Load::default(),
            seed,
            effects: Vec::new(),
            pace: None,
            transport: Transport::Terminal,
            deadline_ms: DEADLINE_MS,
            troubles: Vec::new(),
            others: Vec::new(),
        }
    }

    /// The smallest range of the torque sensor that holds the load, and its nominal torque [Nm].
    pub fn torque_range(&self) -> (Range, f64) {
        match self.load {
            Load::BrakeA => (Range::Fine, 20.0),
            Load::GearAndBrakeB => (Range::Coarse, 200.0),
        }
    }

    pub fn hiding(mut self, effects: &[&str]) -> Self {
        self.effects = effects.iter().map(|effect| (*effect).to_owned()).collect();
        self
    }
}

/// Where the instruments answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MockPorts {
    pub joint: Address,
    pub torque_sensor: Address,
    pub brake: Address,
}

#[derive(Debug, thiserror::Error)]
pub enum MockError {
    #[error("effect {0} is not known to the mock bench: expected one of {known}", known = HIDDEN_EFFECTS.join(", "))]
    UnknownEffect(String),
    #[error("pace {0} of the mock bench: expected a number above 0")]
    Pace(f64),
    #[error("the mock bench gets no port from the system: {0}")]
    Port(#[from] io::Error),
}

/// Simulated instruments that answer until this is dropped.
pub struct MockBench {
    settings: MockSettings,
    truth: Truth,
    rig: Arc<Mutex<Rig>>,
    clock: Arc<SteppedClock>,
    ports: Vec<(MockInstrument, Arc<Port>)>,
    threads: Vec<JoinHandle<()>>,
}

impl MockBench {
    pub fn start(settings: MockSettings) -> Result<Self, MockError> {
        if let Some(pace) = settings.pace
            && !(pace.is_finite() && pace > 0.0)
        {
            return Err(MockError::Pace(pace));
        }
        let hidden =
            Hidden::draw(settings.joint, settings.seed, &settings.effects).map_err(MockError::UnknownEffect)?;
        let plant = Plant::new(settings.joint, settings.load, settings.seed, hidden);
        let truth = plant.truth(settings.joint, settings.seed);
        let rig =
            Arc::new(Mutex::new(Rig::new(plant, Odrive::new(settings.joint), &settings.others, &settings.troubles)));
        let clock = Arc::new(SteppedClock::new(Arc::clone(&rig), settings.pace));
        let mut bench = Self { settings, truth, rig, clock, ports: Vec::new(), threads: Vec::new() };
        let others = bench.settings.others.clone().into_iter();
        for instrument in MockInstrument::JOINT_BENCH.into_iter().chain(others) {
            if bench.address(instrument).is_some() {
                continue;
            }
            let rig = Arc::clone(&bench.rig);
            let (port, thread) = match bench.settings.transport {
                #[cfg(unix)]
                Transport::Terminal => serve_terminal(instrument, rig)?,
                _ => serve_tcp(instrument, rig)?,
            };
            bench.ports.push((instrument, port));
            bench.threads.push(thread);
        }
        Ok(bench)
    }

    pub fn ports(&self) -> MockPorts {
        let address = |wanted| self.address(wanted).expect("every mock bench has these");
        MockPorts {
            joint: address(MockInstrument::Joint),
            torque_sensor: address(MockInstrument::TorqueSensor),
            brake: address(MockInstrument::Brake),
        }
    }

    /// Moves only in `sleep_until_s`.
    pub fn clock(&self) -> Arc<dyn Clock> {
        Arc::clone(&self.clock) as Arc<dyn Clock>
    }

    pub fn settings(&self) -> &MockSettings {
        &self.settings
    }

    /// What this bench hides. Nothing of it is on any wire.
    pub fn truth(&self) -> &Truth {
        &self.truth
    }

    /// Gives an instrument a bad day, or ends it.
    pub fn trouble(&self, instrument: MockInstrument, trouble: Trouble) {
        lock(&self.rig).afflict(instrument, trouble);
    }

    /// The bench with the ordinary drivers on the ports of this mock bench.
    pub fn open_bench(&self, name: &str) -> Result<Bench, Fault> {
        let ports = self.ports();
        let (range, nominal_nm) = self.settings.torque_range();
        let joint = OdriveJoint::open(
            OdriveSettings {
                name: "joint".into(),
                port: PortSettings::new(ports.joint, 921_600),
                deadline_ms: self.settings.deadline_ms,
                link_encoder: true,
                thermistor: Some(Thermistor::Motor),
            },
            self.clock(),
        )?;
        let torque_sensor = LorenzSensor::open(LorenzSettings {
            name: "torque_sensor".into(),
            port: PortSettings::new(ports.torque_sensor, 230_400),
            deadline_ms: self.settings.deadline_ms,
            range,
            nominal_nm,
        })?;
        let brake = ScpiSource::open(ScpiSettings {
            name: "brake_a".into(),
            port: PortSettings::new(ports.brake, 115_200),
            deadline_ms: self.settings.deadline_ms,
        })?;
        Ok(Bench {
            name: name.to_owned(),
            simulated: true,
            clock: self.clock(),
            limits: self.settings.joint.limits(self.settings.load),
            constants: self.settings.joint.constants(self.settings.load),
            joint: Box::new(joint),
            torque_sensor: Some(Box::new(torque_sensor)),
            brake: Some(Box::new(brake)),
        })
    }

    /// Where an instrument answers now. `None`: this bench does not have it.
    pub fn address(&self, wanted: MockInstrument) -> Option<Address> {
        self.ports.iter().find(|(instrument, _)| *instrument == wanted).map(|(_, port)| port.address())
    }
}

impl Drop for MockBench {
    fn drop(&mut self) {
        self.ports.iter().for_each(|(_, port)| port.close());
        for thread in self.threads.drain(..) {
            if thread.join().is_err() {
                tracing::error!("a mock instrument's thread has panicked");
            }
        }
    }
}
