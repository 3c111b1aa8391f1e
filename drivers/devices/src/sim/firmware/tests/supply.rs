//! A supply on the coil of the brake, for its tests.

use crate::sim::data_sheet::{Joint, Load};
use crate::sim::firmware::Firmware;
use crate::sim::plant::{Hidden, Plant, STEP_S};

pub struct Supply<F>(F, Plant);

impl<F: Firmware> Supply<F> {
    pub fn new(firmware: F) -> Self {
        Self(firmware, Plant::new(Joint::JointA, Load::BrakeA, 1, Hidden::default()))
    }

    pub fn exchange(&mut self, text: &str) -> String {
        let mut output = Vec::new();
        self.0.receive(&mut text.as_bytes().to_vec(), &mut self.1, &mut output);
        String::from_utf8(output).unwrap()
    }

    pub fn wait(&mut self, seconds: f64) {
        for _ in 0..(seconds / STEP_S) as usize {
            self.0.step(&mut self.1);
            self.1.advance();
        }
    }
}
