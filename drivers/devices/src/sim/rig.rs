//! Everything behind the wires: the plant and the instruments' firmware, advanced together.

use super::firmware::{Dp800, Firmware, Lorenz, Odrive};
use super::plant::{Plant, STEP_S};
use serde::{Deserialize, Serialize};

/// The instruments of a mock bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MockInstrument {
    Joint,
    TorqueSensor,
    Brake,
}

impl MockInstrument {
    pub const ALL: [MockInstrument; 3] = [MockInstrument::Joint, MockInstrument::TorqueSensor, MockInstrument::Brake];

    pub(super) fn label(self) -> &'static str {
        match self {
            MockInstrument::Joint => "joint",
            MockInstrument::TorqueSensor => "torque_sensor",
            MockInstrument::Brake => "brake",
        }
    }
}

pub(super) struct Rig {
    pub plant: Plant,
    joint: Odrive,
    torque_sensor: Lorenz,
    brake: Dp800,
}

impl Rig {
    pub fn new(plant: Plant, joint: Odrive) -> Self {
        Self { plant, joint, torque_sensor: Lorenz::new(), brake: Dp800::new() }
    }

    pub fn advance(&mut self) {
        self.joint.step(&mut self.plant);
        self.brake.step(&mut self.plant);
        self.torque_sensor.step(&mut self.plant);
        self.plant.advance();
    }

    /// Substeps until the plant shows `t_s`.
    pub fn advance_until(&mut self, t_s: f64) {
        while self.plant.now_s() + 0.5 * STEP_S < t_s {
            self.advance();
        }
    }

    /// Hands `input` to an instrument; what it does not understand yet stays in `input`.
    pub fn receive(&mut self, instrument: MockInstrument, input: &mut Vec<u8>, output: &mut Vec<u8>) {
        let firmware: &mut dyn Firmware = match instrument {
            MockInstrument::Joint => &mut self.joint,
            MockInstrument::TorqueSensor => &mut self.torque_sensor,
            MockInstrument::Brake => &mut self.brake,
        };
        firmware.receive(input, &mut self.plant, output);
    }

    /// What an instrument sends without being asked.
    pub fn unasked(&mut self, instrument: MockInstrument, output: &mut Vec<u8>) {
        if instrument == MockInstrument::TorqueSensor {
            self.torque_sensor.take_stream(output);
        }
    }

    pub fn is_streaming(&self, instrument: MockInstrument) -> bool {
        instrument == MockInstrument::TorqueSensor && self.torque_sensor.is_streaming()
    }
}
