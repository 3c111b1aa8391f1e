//! The instruments' side of each protocol, faithful to what the makers publish rather than to what our drivers need.

mod adam;
mod dmm;
mod dp800;
mod dp800_channel;
mod dp800_commands;
mod gcs;
mod gcs_motion;
mod hmp;
mod lines;
mod lorenz;
mod odrive;
mod odrive_lines;
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
pub use lorenz::Lorenz;
pub use odrive::Odrive;
pub use puma::{AMPERES_PER_VOLT, ENCODER_COUNTS as PUMA_COUNTS, Puma};
pub use qsb::{Encoder, Qsb};

use super::plant::Plant;
use super::trouble::Trouble;

pub trait Firmware {
    /// Handles the complete requests at the front of `input` and takes them out; replies go to `output`.
    fn receive(&mut self, input: &mut Vec<u8>, plant: &mut Plant, output: &mut Vec<u8>);

    /// One control period of the instrument, before the plant moves on.
    fn step(&mut self, plant: &mut Plant);

    /// Takes what it sends without being asked.
    fn unasked(&mut self, _output: &mut Vec<u8>) {}

    /// It sends without being asked, now and then.
    fn is_streaming(&self) -> bool {
        false
    }

    /// The bad day that it has. Troubles of the cable and of the plant are none of its business.
    fn afflict(&mut self, trouble: Trouble);

    /// Power went and came back: what is not kept in memory is lost.
    fn power_cycle(&mut self, plant: &mut Plant);
}
