//! The instruments' side of each protocol, faithful to what the makers publish rather than to what our drivers need.

mod dp800;
mod dp800_channel;
mod dp800_commands;
mod lorenz;
mod odrive;
mod odrive_lines;
mod odrive_properties;
mod scan;
mod scpi;
#[cfg(test)]
mod tests;

pub use dp800::Dp800;
pub use lorenz::Lorenz;
pub use odrive::Odrive;

use super::plant::Plant;
use super::trouble::Trouble;

pub trait Firmware {
    /// Handles the complete requests at the front of `input` and takes them out; replies go to `output`.
    fn receive(&mut self, input: &mut Vec<u8>, plant: &mut Plant, output: &mut Vec<u8>);

    /// One control period of the instrument, before the plant moves on.
    fn step(&mut self, plant: &mut Plant);

    /// The bad day that it has. Troubles of the cable and of the plant are none of its business.
    fn afflict(&mut self, trouble: Trouble);

    /// Power went and came back: what is not kept in memory is lost.
    fn power_cycle(&mut self, plant: &mut Plant);
}
