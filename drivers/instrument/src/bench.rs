//! One bench: the instruments by role, one clock, one set of limits. One thread owns it.

use crate::roles::{
    AlignmentStage, CurrentSource, Instrument, JointController, PositionCounter, PowerSwitch, Thermometer, TorqueSensor,
};
use crate::{Clock, Fault, Limits, TorsionLimit};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The constants of the joint under test that every run records.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointConstants {
    /// k_m.
    pub torque_constant_nm_per_a: f64,
    /// N: motor turns for each link turn.
    pub gear_ratio: f64,
    /// Moment of inertia of the motor's rotor, motor side.
    pub rotor_inertia_kg_m2: f64,
    /// Coil resistance and rating of the brake determine the supply's compliance voltage. A bench without a brake has 0
    /// here and in its ratings.
    pub brake_compliance_v: f64,
    /// Rated current of the brake's coil.
    pub brake_rated_current_a: f64,
    /// Torque of the brake at rated current, link side.
    pub brake_rated_torque_nm: f64,
    /// Permitted rotation of the link to either side of the zero of its encoder. `None`: unlimited.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link_range_rad: Option<f64>,
    /// Turns of the brake for each turn of the link, with a load gear between torque sensor and brake. `None`: the
    /// brake is on the link.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load_gear_ratio: Option<f64>,
}

/// The instruments of a bench. A missing instrument is an empty slot, never a dummy.
pub struct Bench {
    /// Name in the bench description; every run records it.
    pub name: String,
    /// The instruments are those of the mock bench.
    pub simulated: bool,
    /// The time of every reading and command.
    pub clock: Arc<dyn Clock>,
    /// Values that no command and no sample may exceed.
    pub limits: Limits,
    /// `None`: the torsion of the joint is not monitored.
    pub torsion: Option<TorsionLimit>,
    /// Constants of the joint under test and its brake.
    pub constants: JointConstants,
    /// Drive of the joint, which also reads its encoders.
    pub joint: Box<dyn JointController>,
    /// Torque between joint and load, link side.
    pub torque_sensor: Option<Box<dyn TorqueSensor>>,
    /// Supply of the brake's coil.
    pub brake: Option<Box<dyn CurrentSource>>,
    /// S1 of an encoder bench, on the motor shaft.
    pub reference_encoder: Option<Box<dyn PositionCounter>>,
    /// S2, the encoder under test, on the same shaft.
    pub test_encoder: Option<Box<dyn PositionCounter>>,
    /// Holds the sensor of the encoder under test.
    pub stage: Option<Box<dyn AlignmentStage>>,
    /// Temperatures of the joint and its surroundings.
    pub thermometer: Option<Box<dyn Thermometer>>,
    /// Switches instruments off and on. `None`: a person has to do it.
    pub power: Option<Box<dyn PowerSwitch>>,
}

impl Bench {
    /// Records the traffic of every instrument in `folder` from now on, one file each (`joint.traffic`), and returns
    /// the files. `None` ends the recording. If one instrument cannot record, all recordings end.
    pub fn record(&mut self, folder: Option<&Path>) -> Result<Vec<PathBuf>, Fault> {
        let mut files = Vec::new();
        for instrument in self.instruments() {
            let file = folder.map(|folder| folder.join(format!("{}.traffic", instrument.name())));
            if let Err(fault) = instrument.record(file.as_deref()) {
                self.record(None)?;
                return Err(fault);
            }
            files.extend(file);
        }
        Ok(files)
    }

    /// The instrument with this name in the bench description.
    pub fn instrument(&mut self, name: &str) -> Option<&mut dyn Instrument> {
        self.instruments().into_iter().find(|instrument| instrument.name() == name)
    }

    /// Every instrument of the bench, the joint first.
    pub fn instruments(&mut self) -> Vec<&mut dyn Instrument> {
        let mut instruments: Vec<&mut dyn Instrument> = vec![self.joint.as_mut()];
        instruments.extend(self.torque_sensor.as_mut().map(|sensor| -> &mut dyn Instrument { sensor.as_mut() }));
        instruments.extend(self.brake.as_mut().map(|brake| -> &mut dyn Instrument { brake.as_mut() }));
        let counters = [&mut self.reference_encoder, &mut self.test_encoder];
        instruments.extend(counters.into_iter().flatten().map(|counter| -> &mut dyn Instrument { counter.as_mut() }));
        instruments.extend(self.stage.as_mut().map(|stage| -> &mut dyn Instrument { stage.as_mut() }));
        instruments
            .extend(self.thermometer.as_mut().map(|thermometer| -> &mut dyn Instrument { thermometer.as_mut() }));
        instruments
    }
}
