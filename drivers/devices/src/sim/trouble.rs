//! Bad days by name.

use super::rig::MockInstrument;
use serde::{Deserialize, Serialize};

/// A bad day of one instrument. Lasts until another is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Trouble {
    #[default]
    None,
    /// Hears and does what it is told, but its replies are lost.
    Silent,
    /// Replies are held back until the trouble ends, and come all at once then.
    Late,
    /// One byte of every reply is wrong.
    Garbled,
    /// The second half of every reply is lost.
    Truncated,
    /// Every reply comes twice.
    Doubled,
    /// Every reply is the one to the question before.
    Stale,
    /// The cable is out. A pseudo-terminal comes back under another name, a TCP port under the same.
    Unplugged,
    /// Without power while it lasts, and booted afresh at its end: what is not kept in memory is lost.
    PowerCycled,
    /// Another unit of the same model answers, on the same port and in the same state, but that it sends no stream.
    Exchanged,
    /// Every request is refused, each protocol in its own way.
    Refusing,
    /// The torque sensor's stream loses frames.
    StreamGap,
    /// The torque sensor's zero is off by more than its small range and less than its large one.
    Saturated,
    /// A loose contact in the circuit of the brake's coil: the supply runs out of voltage.
    CurrentLost,
    /// The joint's thermistor shows far too much.
    OverTemperature,
    /// What is recorded finds no room: not an instrument's, but [`MockInstrument::Disk`]'s.
    DiskFull,
}

impl Trouble {
    /// Whether an instrument can have it: some are of one kind of instrument only.
    pub fn can_strike(self, instrument: MockInstrument) -> bool {
        use MockInstrument as I;
        match self {
            Trouble::StreamGap => instrument == I::TorqueSensor,
            Trouble::Saturated => matches!(instrument, I::TorqueSensor | I::Thermometer),
            Trouble::CurrentLost => instrument == I::Brake,
            Trouble::OverTemperature => instrument == I::Joint,
            Trouble::DiskFull => instrument == I::Disk,
            _ => true,
        }
    }
}

/// A bad day that begins by itself.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedTrouble {
    pub instrument: MockInstrument,
    pub trouble: Trouble,
    /// On the bench's clock.
    pub from_s: f64,
    /// `None`: for ever.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until_s: Option<f64>,
}

/// What a trouble on the cable makes of replies. Remembers what it holds back.
#[derive(Default)]
pub(super) struct Cable {
    held: Vec<u8>,
}

impl Cable {
    pub fn carry(&mut self, trouble: Trouble, output: &mut Vec<u8>) {
        match trouble {
            Trouble::Silent => output.clear(),
            Trouble::Late => self.held.append(output),
            // The middle of a line or telegram; a flipped bit of this weight is wrong in each of the protocols.
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
