//! The mock bench as seen by its owner.

use super::clock::SteppedClock;
use super::data_sheet::{DataSheet, Joint, Load};
use super::firmware::{AMPERES_PER_VOLT, Firmware, Odrive, PUMA_COUNTS, Puma};
use super::plant::{Hidden, Plant, Truth};
#[cfg(unix)]
use super::port::serve_terminal;
use super::port::{Line, Port, lock, serve_inside, serve_tcp};
use super::rig::{MockInstrument, Rig, Supply};
use super::trouble::{PlannedTrouble, Trouble};
use crate::driver::{
    AdamSettings, GcsSettings, LorenzSettings, OdriveSettings, PumaGains, PumaSettings, QsbSettings, Range,
    ScpiSettings, Thermistor,
};
use crate::instruments::{InstrumentSettings, JointSettings, TorqueSensorSettings};
use crate::protocol::puma::{VAL_INTERVAL, interval};
use crate::transport::{Address, PortSettings};
use jointbench_instrument::bench::JointConstants;
use jointbench_instrument::roles::{PowerSwitch, SetpointInterval};
use jointbench_instrument::{Bench, Clock, Fault, FaultKind, Limits};
use serde::{Deserialize, Serialize};
use std::io;
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

/// Counts per turn of encoders S1 and S2, as known to their owner.
pub const ENCODER_COUNTS: [u32; 2] = [1 << 14, 1 << 18];
/// Long, because other programs share the machine with a simulated instrument.
const DEADLINE_MS: u64 = 3000;

/// The type of the instruments' wires.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Transport {
    /// Inside this process, only for the owner of the bench: fast, and closed to other programs.
    Inside,
    /// Pseudo-terminals; loopback TCP on systems without them.
    Terminal,
    /// Loopback TCP, one port for each instrument.
    Tcp,
}

/// What a mock bench simulates, and how its instruments are reached.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct MockSettings {
    /// The joint under test.
    pub joint: Joint,
    /// Axis of the Puma, 1 to 6.
    pub axis: u8,
    /// Exactly the values of the source documents, instead of values drawn from the seed.
    pub documents: bool,
    /// The load of the joint; determines torque sensor and brake.
    pub load: Load,
    /// Supply of the brake's coil.
    pub supply: Supply,
    /// The same seed gives the same parameters and noise.
    pub seed: u64,
    /// Whether the filter of the encoder under test is on.
    pub filter: bool,
    /// Names from [`Joint::hides`].
    pub effects: Vec<String>,
    /// Bench seconds per second of wall time. `None`: as fast as possible.
    pub pace: Option<f64>,
    /// Wires of all instruments.
    pub transport: Transport,
    /// Bytes take the wall time that they take on the instrument's line, except with [`Transport::Inside`]. Otherwise
    /// they take no time.
    pub paced_lines: bool,
    /// Deadline of the drivers that [`MockBench::open_bench`] opens.
    pub deadline_ms: u64,
    /// Troubles with planned times.
    pub troubles: Vec<PlannedTrouble>,
    /// Instruments in addition to the joint, and to the torque sensor and brake of a bench with a load.
    pub others: Vec<MockInstrument>,
    /// Clock ticks between the set-points of the Puma's servo.
    pub ninter: u8,
    /// Gains of the Puma's servo.
    pub gains: PumaGains,
}

impl MockSettings {
    /// Default bench of a joint: an encoder shaft has no load and the instruments of its bench, an arm has only its
    /// servo.
    pub fn new(joint: Joint, seed: u64) -> Self {
        let (load, others) = match joint {
            Joint::JointA | Joint::JointB => (Load::default(), Vec::new()),
            Joint::EncoderShaft => (Load::None, MockInstrument::ENCODER_BENCH.to_vec()),
            Joint::Puma => (Load::None, Vec::new()),
        };
        Self {
            joint,
            axis: 2,
            documents: false,
            load,
            supply: Supply::default(),
            seed,
            filter: false,
            effects: Vec::new(),
            pace: None,
            transport: Transport::Inside,
            paced_lines: false,
            deadline_ms: DEADLINE_MS,
            troubles: Vec::new(),
            others,
            ninter: VAL_INTERVAL,
            gains: PumaGains::default(),
        }
    }

    fn data_sheet(&self) -> DataSheet {
        let sheet = DataSheet::of(self.joint, self.axis);
        if self.documents { sheet.exact() } else { sheet }
    }

    /// The constants that a description of this bench states.
    pub fn constants(&self) -> JointConstants {
        self.data_sheet().constants(self.load)
    }

    /// The limits of this bench.
    pub fn limits(&self) -> Limits {
        self.data_sheet().limits(self.load)
    }

    /// The smallest range of the torque sensor that suits the load, and its nominal torque (Nm).
    fn torque_range(&self) -> Option<(Range, f64)> {
        match self.load {
            Load::BrakeA => Some((Range::Fine, 20.0)),
            Load::GearAndBrakeB => Some((Range::Coarse, 200.0)),
            Load::None => None,
        }
    }

    /// Motor current per volt, if the joint's servo measures it as the voltage at a shunt.
    pub fn amperes_per_volt(&self) -> Option<f64> {
        (self.joint == Joint::Puma).then_some(AMPERES_PER_VOLT)
    }

    /// Interpolation of position set-points, if the joint's servo accepts positions.
    pub fn setpoint_interval(&self) -> Option<SetpointInterval> {
        interval(self.ninter).filter(|_| self.joint == Joint::Puma)
    }

    /// Whether the joint's servo accepts a feed-forward motor current in addition to a velocity.
    pub fn feeds_forward(&self) -> bool {
        self.joint != Joint::Puma
    }

    /// The bench has this instrument.
    pub fn has(&self, instrument: MockInstrument) -> bool {
        self.instruments().contains(&instrument)
    }

    fn instruments(&self) -> Vec<MockInstrument> {
        let base: &[MockInstrument] = match self.load {
            Load::None => &[MockInstrument::Joint],
            _ => &MockInstrument::JOINT_BENCH,
        };
        let mut all = base.to_vec();
        all.extend(self.others.iter().filter(|other| !base.contains(other)));
        all
    }

    /// The same bench with these hidden effects, by the names of [`Joint::hides`].
    pub fn hiding(mut self, effects: &[&str]) -> Self {
        self.effects = effects.iter().map(|effect| (*effect).to_owned()).collect();
        self
    }
}

/// Why a mock bench does not start.
#[derive(Debug, thiserror::Error)]
pub enum MockError {
    /// This joint cannot hide the effect.
    #[error("effect {effect}: this mock bench can hide {known}", known = joint.hides().join(", "))]
    UnknownEffect {
        /// Name of the effect.
        effect: String,
        /// The joint of the settings.
        joint: Joint,
    },
    /// The pace is 0, negative, or not a number.
    #[error("pace {0} of the mock bench: expected a number above 0")]
    Pace(f64),
    /// The operating system refuses a terminal, socket or thread.
    #[error("the system provides no port for the mock bench: {0}")]
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
    /// Draws the hidden parameters and starts every instrument.
    pub fn start(settings: MockSettings) -> Result<Self, MockError> {
        if let Some(pace) = settings.pace
            && !(pace.is_finite() && pace > 0.0)
        {
            return Err(MockError::Pace(pace));
        }
        let sheet = settings.data_sheet();
        let hidden = Hidden::draw(sheet, settings.seed, &settings.effects)
            .map_err(|effect| MockError::UnknownEffect { effect, joint: settings.joint })?;
        let mut plant = Plant::new(sheet, settings.load, settings.seed, hidden);
        plant.filter_s2(settings.filter);
        let truth = plant.truth(settings.seed);
        let joint: Box<dyn Firmware + Send> = match settings.joint {
            Joint::Puma => Box::new(Puma::new()),
            _ => Box::new(Odrive::new(sheet)),
        };
        let rig = Arc::new(Mutex::new(Rig::new(plant, joint, settings.supply, &settings.others, &settings.troubles)));
        let clock = Arc::new(SteppedClock::new(Arc::clone(&rig), settings.pace));
        let mut bench = Self { settings, truth, rig, clock, ports: Vec::new(), threads: Vec::new() };
        for instrument in bench.settings.instruments() {
            if bench.address(instrument).is_some() {
                continue;
            }
            let rig = Arc::clone(&bench.rig);
            let line = if bench.settings.paced_lines { Line::paced(instrument.baud()) } else { Line::default() };
            let (port, thread) = match bench.settings.transport {
                Transport::Inside => (serve_inside(instrument, rig), None),
                #[cfg(unix)]
                Transport::Terminal => serve_terminal(instrument, rig, line)?,
                _ => serve_tcp(instrument, rig, line)?,
            };
            bench.ports.push((instrument, port));
            bench.threads.extend(thread);
        }
        Ok(bench)
    }

    /// A clock that advances only in `sleep_until_s`.
    pub fn clock(&self) -> Arc<dyn Clock> {
        Arc::clone(&self.clock) as Arc<dyn Clock>
    }

    /// The settings with which it was started.
    pub fn settings(&self) -> &MockSettings {
        &self.settings
    }

    /// The hidden parameters of this bench. They are never sent over a wire.
    pub fn truth(&self) -> &Truth {
        &self.truth
    }

    /// Starts or ends a trouble of an instrument.
    pub fn trouble(&self, instrument: MockInstrument, trouble: Trouble) {
        lock(&self.rig).apply_trouble(instrument, trouble);
    }

    /// Whether the recorder of this bench is to find a full disk.
    pub fn disk_is_full(&self) -> bool {
        lock(&self.rig).trouble(MockInstrument::Disk) == Trouble::DiskFull
    }

    fn joint(&self) -> JointSettings {
        let (name, deadline_ms) = ("joint".into(), self.settings.deadline_ms);
        let address = self.address(MockInstrument::Joint).expect("every mock bench has a joint");
        match self.settings.joint {
            Joint::Puma => JointSettings::Puma(PumaSettings {
                name,
                port: PortSettings::new(address, 115_200),
                deadline_ms,
                counts_per_turn: PUMA_COUNTS,
                amperes_per_volt: AMPERES_PER_VOLT,
                ninter: self.settings.ninter,
                gains: self.settings.gains,
            }),
            _ => JointSettings::Odrive(OdriveSettings {
                name,
                port: PortSettings::new(address, MockInstrument::Joint.baud()),
                deadline_ms,
                link_encoder: self.settings.load != Load::None,
                thermistor: Some(Thermistor::Motor),
            }),
        }
    }

    /// The settings with which the ordinary drivers reach the instruments of this bench.
    pub fn instruments(&self) -> InstrumentSettings {
        let deadline_ms = self.settings.deadline_ms;
        let port = |instrument: MockInstrument| {
            self.address(instrument).map(|address| PortSettings::new(address, instrument.baud()))
        };
        let counter = |name: &str, instrument, counts_per_turn, status_input| {
            let port = port(instrument)?;
            let (name, reversed) = (name.into(), false);
            Some(QsbSettings { name, port, deadline_ms, counts_per_turn, reversed, status_input })
        };
        let torque_sensor = self.settings.torque_range().zip(port(MockInstrument::TorqueSensor));
        InstrumentSettings {
            joint: self.joint(),
            torque_sensor: torque_sensor.map(|((range, nominal_nm), port)| {
                let name = "torque_sensor".into();
                TorqueSensorSettings::Lorenz(LorenzSettings { name, port, deadline_ms, range, nominal_nm })
            }),
            brake: port(MockInstrument::Brake).map(|port| ScpiSettings { name: "brake_a".into(), port, deadline_ms }),
            reference_encoder: counter("s1", MockInstrument::CounterS1, ENCODER_COUNTS[0], None),
            test_encoder: counter("s2", MockInstrument::CounterS2, ENCODER_COUNTS[1], Some(0)),
            stage: port(MockInstrument::Stage).map(|port| GcsSettings { name: "stage".into(), port, deadline_ms }),
            thermometer: port(MockInstrument::Thermometer).map(|port| AdamSettings {
                name: "thermometer".into(),
                port,
                deadline_ms,
                slave: 1,
                channels: if self.settings.joint == Joint::Puma { vec![1, 5] } else { vec![0, 1, 5] },
            }),
        }
    }

    /// The bench with the ordinary drivers on the ports of this mock bench.
    pub fn open_bench(&self, name: &str) -> Result<Bench, Fault> {
        let opened = self.instruments().open(&self.clock());
        if let Some(fault) = opened.asked.iter().find_map(|asked| asked.identity.as_ref().err()) {
            return Err(fault.clone());
        }
        let (limits, constants) = (self.settings.limits(), self.settings.constants());
        let bench = opened.into_bench(name, true, self.clock(), limits, constants).expect("every instrument answers");
        Ok(Bench { power: Some(self.power_switch()), ..bench })
    }

    /// As if the process that opened the instruments were killed: they keep their state and can be opened again. Only
    /// for instruments inside this process; the system does it for its own ports.
    pub fn orphan(&self) {
        self.ports.iter().for_each(|(_, port)| port.release());
    }

    /// Switches the power of an encoder and its counter off and on, by the names of [`MockBench::instruments`].
    pub fn power_switch(&self) -> Box<dyn PowerSwitch> {
        Box::new(Switch(Arc::clone(&self.rig)))
    }

    /// Name and present address of every instrument.
    pub fn addresses(&self) -> Vec<(&'static str, Address)> {
        self.ports.iter().map(|(instrument, port)| (instrument.label(), port.address())).collect()
    }

    /// Present address of an instrument. `None`: this bench does not have it.
    pub fn address(&self, wanted: MockInstrument) -> Option<Address> {
        self.ports.iter().find(|(instrument, _)| *instrument == wanted).map(|(_, port)| port.address())
    }
}

struct Switch(Arc<Mutex<Rig>>);

impl PowerSwitch for Switch {
    fn cycle(&mut self, instrument: &str) -> Result<(), Fault> {
        let found = match instrument {
            "s1" => MockInstrument::CounterS1,
            "s2" => MockInstrument::CounterS2,
            other => {
                let what = format!("no instrument {other} is on this switch");
                return Err(FaultKind::Refused { what }.at("power switch", ""));
            }
        };
        let mut rig = lock(&self.0);
        rig.apply_trouble(found, Trouble::PowerCycled);
        rig.apply_trouble(found, Trouble::None);
        Ok(())
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
