//! Simulated troubles by name.

use super::rig::MockInstrument;
use serde::{Deserialize, Serialize};

/// A simulated trouble of one instrument. Lasts until another one is set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Trouble {
    /// Works as it should.
    #[default]
    None,
    /// Receives and executes commands, but its replies are lost.
    Silent,
    /// Replies are delayed until the trouble ends, then all arrive at once.
    Late,
    /// One byte of every reply is wrong.
    Garbled,
    /// The second half of every reply is lost.
    Truncated,
    /// Every reply comes twice.
    Doubled,
    /// Every reply is that of the previous request.
    Stale,
    /// The cable is unplugged. A pseudo-terminal returns under another name, a TCP port under the same.
    Unplugged,
    /// Without power during the trouble, then rebooted: volatile state is lost.
    PowerCycled,
    /// Another unit of the same model answers, on the same port and in the same state, but without a running stream.
    Exchanged,
    /// Every request is refused, each protocol in its own way.
    Refusing,
    /// The torque sensor's stream loses frames.
    StreamGap,
    /// The torque sensor's zero is off by more than its small range and less than its large one.
    Saturated,
    /// A loose contact in the coil circuit of the brake: the supply reaches its voltage limit.
    CurrentLost,
    /// The joint's thermistor shows a much too high temperature.
    OverTemperature,
    /// The coupling between gear and link slips beyond a small torque. Its displacement remains.
    CouplingSlips,
    /// The disk for records is full. Not for an instrument, but for [`MockInstrument::Disk`].
    DiskFull,
}

impl Trouble {
    /// Whether an instrument can have this trouble: some apply only to one kind of instrument.
    pub fn can_strike(self, instrument: MockInstrument) -> bool {
        use MockInstrument as I;
        match self {
            Trouble::StreamGap => instrument == I::TorqueSensor,
            Trouble::Saturated => matches!(instrument, I::TorqueSensor | I::Thermometer),
            Trouble::CurrentLost => instrument == I::Brake,
            Trouble::OverTemperature | Trouble::CouplingSlips => instrument == I::Joint,
            Trouble::DiskFull => instrument == I::Disk,
            _ => true,
        }
    }
}

/// A planned trouble with its start and end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedTrouble {
    /// The instrument with the trouble.
    pub instrument: MockInstrument,
    /// The trouble; [`Trouble::can_strike`] must hold.
    pub trouble: Trouble,
    /// Time on the bench clock.
    pub from_s: f64,
    /// `None`: for ever.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until_s: Option<f64>,
}

/// The effect of a cable trouble on replies. Stores delayed bytes.
#[derive(Default)]
pub(super) struct Cable {
    held: Vec<u8>,
}

impl Cable {
    pub fn carry(&mut self, trouble: Trouble, output: &mut Vec<u8>) {
        match trouble {
            Trouble::Silent => output.clear(),
            Trouble::Late => self.held.append(output),
            // The middle of a line or telegram; a flipped bit of this weight is an error in each protocol.
            Trouble::Garbled => {
                let middle = output.len() / 2;
                if let Some(byte) = output.get_mut(middle) {
                    *byte ^= 0x40;
                }
            }
            Trouble::Truncated => output.truncate(output.len() / 2),
            Trouble::Doubled => output.extend_from_within(..),
            Trouble::Stale if output.is_empty() => {}
            Trouble::Stale => std::mem::swap(&mut self.held, output),
            _ => drop(output.splice(0..0, self.held.drain(..))),
        }
    }
}
