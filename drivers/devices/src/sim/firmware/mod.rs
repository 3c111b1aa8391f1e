//! The instruments' side of each protocol, according to the makers' documents and not to the needs of our drivers.

mod adam;
mod dmm;
mod dp800;
mod dp800_channel;
mod dp800_commands;
mod gcs;
mod gcs_motion;
mod hmp;
mod kepco;
mod lines;
mod lorenz;
mod odrive;
mod odrive_lines;
mod odrive_position;
mod odrive_properties;
mod puma;
mod puma_loop;
mod puma_memory;
mod puma_orders;
mod qsb;
mod qsb_registers;
mod scan;
mod scpi;
mod supply_output;
#[cfg(test)]
mod tests;

pub use adam::Adam;
pub use dmm::Dmm;
pub use dp800::Dp800;
pub use gcs::Gcs;
pub use hmp::Hmp;
pub use kepco::Kepco;
pub use lorenz::Lorenz;
pub use odrive::Odrive;
pub use puma::{AMPERES_PER_VOLT, ENCODER_COUNTS as PUMA_COUNTS, Puma};
pub use qsb::{Encoder, Qsb};

use super::plant::Plant;
use super::trouble::Trouble;

pub trait Firmware {
    /// Handles the complete requests at the start of `input` and removes them; replies are appended to `output`.
    fn receive(&mut self, input: &mut Vec<u8>, plant: &mut Plant, output: &mut Vec<u8>);

    /// One control period of the instrument, before the plant advances.
    fn step(&mut self, plant: &mut Plant);

    /// Appends bytes that the instrument sends without a request.
    fn unasked(&mut self, _output: &mut Vec<u8>) {}

    /// The instrument sends without requests at present.
    fn is_streaming(&self) -> bool {
        false
    }

    /// Sets the trouble of this instrument. Troubles of the cable and of the plant have no effect here.
    fn apply_trouble(&mut self, trouble: Trouble);

    /// The power was interrupted: volatile state is lost.
    fn power_cycle(&mut self, plant: &mut Plant);
}
