//! The instruments of one bench: the settings to reach them, and the result of opening them.

use crate::driver::{
    AdamSettings, AdamThermometer, DmmSettings, DmmTorqueSensor, GcsSettings, GcsStage, LorenzSensor, LorenzSettings,
    OdriveJoint, OdriveSettings, PumaAxis, PumaSettings, QsbCounter, QsbSettings, ScpiSettings, ScpiSource,
};
use crate::protocol::puma::interval;
use crate::transport::PortSettings;
use jointbench_instrument::bench::JointConstants;
use jointbench_instrument::roles::{
    AlignmentStage, CurrentSource, Identity, Instrument, JointController, PositionCounter, SetpointInterval,
    Thermometer, TorqueSensor,
};
use jointbench_instrument::{Bench, Clock, Fault, Limits};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

/// Connection settings of each instrument. A missing instrument is an empty slot.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct InstrumentSettings {
    /// Drive of the joint under test.
    pub joint: JointSettings,
    /// Torque between joint and load.
    pub torque_sensor: Option<TorqueSensorSettings>,
    /// Supply of the brake's coil.
    pub brake: Option<ScpiSettings>,
    /// Counter of encoder S1.
    pub reference_encoder: Option<QsbSettings>,
    /// Counter of encoder S2, the encoder under test.
    pub test_encoder: Option<QsbSettings>,
    /// Stage that holds the sensor of encoder S2.
    pub stage: Option<GcsSettings>,
    /// Temperatures of the joint and its surroundings.
    pub thermometer: Option<AdamSettings>,
}

/// The drive of a joint.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum JointSettings {
    /// ODrive with firmware 0.5.
    Odrive(OdriveSettings),
    /// One axis of a Puma servo.
    Puma(PumaSettings),
}

impl JointSettings {
    fn parts(&mut self) -> (&'static str, &str, &mut PortSettings) {
        match self {
            JointSettings::Odrive(settings) => ("odrive", &settings.name, &mut settings.port),
            JointSettings::Puma(settings) => ("puma", &settings.name, &mut settings.port),
        }
    }

    /// Motor current per volt, if the drive measures it as the voltage at a shunt.
    pub fn amperes_per_volt(&self) -> Option<f64> {
        match self {
            JointSettings::Odrive(_) => None,
            JointSettings::Puma(settings) => Some(settings.amperes_per_volt),
        }
    }

    /// Interpolation of position set-points, if the drive accepts positions.
    pub fn setpoint_interval(&self) -> Option<SetpointInterval> {
        match self {
            JointSettings::Odrive(_) => None,
            JointSettings::Puma(settings) => interval(settings.ninter),
        }
    }

    /// Whether the drive accepts a feed-forward motor current in addition to a velocity.
    pub fn feeds_forward(&self) -> bool {
        matches!(self, JointSettings::Odrive(_))
    }

    fn open(self, clock: Arc<dyn Clock>) -> Result<Box<dyn JointController>, Fault> {
        Ok(match self {
            JointSettings::Odrive(settings) => Box::new(OdriveJoint::open(settings, clock)?),
            JointSettings::Puma(settings) => Box::new(PumaAxis::open(settings, clock)?),
        })
    }
}

/// The torque sensor of a bench.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum TorqueSensorSettings {
    /// Telegrams of a Lorenz sensor.
    Lorenz(LorenzSettings),
    /// On the analogue output of the sensor.
    Multimeter(DmmSettings),
}

impl TorqueSensorSettings {
    /// Nominal torque of the range in use (Nm).
    pub fn nominal_nm(&self) -> f64 {
        match self {
            TorqueSensorSettings::Lorenz(settings) => settings.nominal_nm,
            TorqueSensorSettings::Multimeter(settings) => settings.nominal_nm,
        }
    }

    fn open(self) -> Result<Box<dyn TorqueSensor>, Fault> {
        Ok(match self {
            TorqueSensorSettings::Lorenz(settings) => Box::new(LorenzSensor::open(settings)?),
            TorqueSensorSettings::Multimeter(settings) => Box::new(DmmTorqueSensor::open(settings)?),
        })
    }
}

/// The result of identifying one instrument.
#[derive(Debug, Clone)]
pub struct Asked {
    /// Role on the bench: `joint`, `torque_sensor`.
    pub role: &'static str,
    /// Name in the bench description.
    pub name: String,
    /// Driver of the instrument, as in the bench description.
    pub driver: &'static str,
    /// Port at which it was asked.
    pub port: String,
    /// Its identity, or why it did not answer as expected.
    pub identity: Result<Identity, Fault>,
}

/// The instruments that answered, each in its slot.
pub struct Instruments {
    /// Drive of the joint under test.
    pub joint: Option<Box<dyn JointController>>,
    /// Torque between joint and load.
    pub torque_sensor: Option<Box<dyn TorqueSensor>>,
    /// Supply of the brake's coil.
    pub brake: Option<Box<dyn CurrentSource>>,
    /// Counter of encoder S1.
    pub reference_encoder: Option<Box<dyn PositionCounter>>,
    /// Counter of encoder S2, the encoder under test.
    pub test_encoder: Option<Box<dyn PositionCounter>>,
    /// Stage that holds the sensor of encoder S2.
    pub stage: Option<Box<dyn AlignmentStage>>,
    /// Temperatures of the joint and its surroundings.
    pub thermometer: Option<Box<dyn Thermometer>>,
    /// All described instruments, including those that do not answer.
    pub asked: Vec<Asked>,
}

impl InstrumentSettings {
    /// Records the traffic of every instrument in `folder` from its opening on, one file each (`joint.traffic`).
    /// [`crate::Replay`] can answer from such a file.
    pub fn record_in(&mut self, folder: &Path) {
        let sensor = self.torque_sensor.as_mut().map(|sensor| match sensor {
            TorqueSensorSettings::Lorenz(settings) => (&settings.name, &mut settings.port),
            TorqueSensorSettings::Multimeter(settings) => (&settings.name, &mut settings.port),
        });
        let (_, name, port) = self.joint.parts();
        port.record = Some(folder.join(format!("{name}.traffic")));
        let all = [
            sensor,
            self.brake.as_mut().map(|brake| (&brake.name, &mut brake.port)),
            self.reference_encoder.as_mut().map(|counter| (&counter.name, &mut counter.port)),
            self.test_encoder.as_mut().map(|counter| (&counter.name, &mut counter.port)),
            self.stage.as_mut().map(|stage| (&stage.name, &mut stage.port)),
            self.thermometer.as_mut().map(|thermometer| (&thermometer.name, &mut thermometer.port)),
        ];
        for (name, port) in all.into_iter().flatten() {
            port.record = Some(folder.join(format!("{name}.traffic")));
        }
    }

    /// Opens and identifies every instrument, also after one does not answer. Nothing moves.
    pub fn open(&self, clock: &Arc<dyn Clock>) -> Instruments {
        let mut desk = Desk { asked: Vec::new() };
        let (mut joint, opened) = (self.joint.clone(), self.joint.clone());
        let (driver, name, port) = joint.parts();
        let joint = desk.ask("joint", driver, name, port, || opened.open(Arc::clone(clock)));
        let torque_sensor = self.torque_sensor.clone().and_then(|settings| {
            let (driver, name, port) = match &settings {
                TorqueSensorSettings::Lorenz(lorenz) => ("lorenz", &lorenz.name, &lorenz.port),
                TorqueSensorSettings::Multimeter(dmm) => ("multimeter", &dmm.name, &dmm.port),
            };
            let (name, port) = (name.clone(), port.clone());
            desk.ask("torque_sensor", driver, &name, &port, || settings.open())
        });
        let brake = self.brake.clone().and_then(|settings| {
            let (name, port) = (settings.name.clone(), settings.port.clone());
            desk.ask("brake", "scpi", &name, &port, || {
                Ok(Box::new(ScpiSource::open(settings)?) as Box<dyn CurrentSource>)
            })
        });
        let mut counter = |role, settings: &Option<QsbSettings>| {
            let settings = settings.clone()?;
            let (name, port) = (settings.name.clone(), settings.port.clone());
            desk.ask(role, "qsb", &name, &port, || {
                Ok(Box::new(QsbCounter::open(settings, Arc::clone(clock))?) as Box<dyn PositionCounter>)
            })
        };
        let reference_encoder = counter("reference_encoder", &self.reference_encoder);
        let test_encoder = counter("test_encoder", &self.test_encoder);
        let stage =
            self.stage.clone().and_then(|settings| {
                let (name, port) = (settings.name.clone(), settings.port.clone());
                desk.ask("stage", "gcs", &name, &port, || {
                    Ok(Box::new(GcsStage::open(settings)?) as Box<dyn AlignmentStage>)
                })
            });
        let thermometer = self.thermometer.clone().and_then(|settings| {
            let (name, port) = (settings.name.clone(), settings.port.clone());
            desk.ask("thermometer", "adam", &name, &port, || {
                Ok(Box::new(AdamThermometer::open(settings)?) as Box<dyn Thermometer>)
            })
        });
        let asked = desk.asked;
        Instruments { joint, torque_sensor, brake, reference_encoder, test_encoder, stage, thermometer, asked }
    }
}

struct Desk {
    asked: Vec<Asked>,
}

impl Desk {
    fn ask<T: Instrument + ?Sized>(
        &mut self,
        role: &'static str,
        driver: &'static str,
        name: &str,
        port: &PortSettings,
        open: impl FnOnce() -> Result<Box<T>, Fault>,
    ) -> Option<Box<T>> {
        let opened = open().and_then(|mut instrument| Ok((instrument.identify()?, instrument)));
        let (identity, instrument) = match opened {
            Ok((identity, instrument)) => (Ok(identity), Some(instrument)),
            Err(fault) => (Err(fault), None),
        };
        self.asked.push(Asked { role, driver, name: name.to_owned(), port: port.address.to_string(), identity });
        instrument
    }
}

impl Instruments {
    /// `None` if an instrument does not answer: a bench must be complete.
    pub fn into_bench(
        self,
        name: &str,
        simulated: bool,
        clock: Arc<dyn Clock>,
        limits: Limits,
        constants: JointConstants,
    ) -> Option<Bench> {
        if self.asked.iter().any(|asked| asked.identity.is_err()) {
            return None;
        }
        Some(Bench {
            name: name.to_owned(),
            simulated,
            clock,
            limits,
            torsion: None,
            constants,
            joint: self.joint?,
            torque_sensor: self.torque_sensor,
            brake: self.brake,
            reference_encoder: self.reference_encoder,
            test_encoder: self.test_encoder,
            stage: self.stage,
            thermometer: self.thermometer,
            power: None,
        })
    }
}
