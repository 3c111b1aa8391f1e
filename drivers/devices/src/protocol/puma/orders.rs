//! One type for each command.

use super::frame::Order;
use super::{Status, VOLTS_PER_COUNT};
use jointbench_instrument::FaultKind;
use jointbench_instrument::units::Volts;

/// The joint status word.
#[derive(Debug, Clone, Copy)]
pub struct ReadStatus;

impl Order for ReadStatus {
    type Reply = Status;

    const CODE: u8 = 0x00;
    const NAME: &'static str = "STATUS";

    fn reply(&self, word: u16) -> Result<Status, FaultKind> {
        Ok(Status(word))
    }
}

/// Encoder counts. The word wraps.
#[derive(Debug, Clone, Copy)]
pub struct ReadPosition;

impl Order for ReadPosition {
    type Reply = i16;

    const CODE: u8 = 0x01;
    const NAME: &'static str = "READPOS";

    fn reply(&self, word: u16) -> Result<i16, FaultKind> {
        Ok(word.cast_signed())
    }
}

/// The voltage at the motor's shunt.
#[derive(Debug, Clone, Copy)]
pub struct ReadCurrent;

impl Order for ReadCurrent {
    type Reply = Volts;

    const CODE: u8 = 0x02;
    const NAME: &'static str = "READADC";

    fn reply(&self, word: u16) -> Result<Volts, FaultKind> {
        Ok(Volts(f64::from(word.cast_signed()) * VOLTS_PER_COUNT))
    }
}

/// The reply repeats the set value.
fn taken(sent: u16, held: u16) -> Result<(), FaultKind> {
    if held == sent {
        return Ok(());
    }
    let [sent, held] = [sent, held].map(u16::cast_signed);
    Err(FaultKind::Garbled { what: format!("sent {sent}, but the servo reads back {held}") })
}

/// A position in counts, to be reached in `ninter` ticks.
#[derive(Debug, Clone, Copy)]
pub struct PositionMode(pub i16);

impl Order for PositionMode {
    type Reply = ();

    const CODE: u8 = 0x03;
    const NAME: &'static str = "POSMODE";

    fn word(&self) -> u16 {
        self.0.cast_unsigned()
    }

    fn reply(&self, word: u16) -> Result<(), FaultKind> {
        taken(self.word(), word)
    }
}

/// A motor current in converter counts, without a control loop.
#[derive(Debug, Clone, Copy)]
pub struct CurrentMode(pub i16);

impl Order for CurrentMode {
    type Reply = ();

    const CODE: u8 = 0x04;
    const NAME: &'static str = "CURMODE";

    fn word(&self) -> u16 {
        self.0.cast_unsigned()
    }

    fn reply(&self, word: u16) -> Result<(), FaultKind> {
        taken(self.word(), word)
    }
}

/// Drive off, holding brake on.
#[derive(Debug, Clone, Copy)]
pub struct Stop;

impl Order for Stop {
    type Reply = ();

    const CODE: u8 = 0x05;
    const NAME: &'static str = "STOPMODE";

    fn reply(&self, word: u16) -> Result<(), FaultKind> {
        taken(self.word(), word)
    }
}

/// Arm power on and holding brake off: the servo holds its present position.
#[derive(Debug, Clone, Copy)]
pub struct ArmPower;

impl Order for ArmPower {
    type Reply = ();

    const CODE: u8 = 0x06;
    const NAME: &'static str = "ARMPOWER";

    fn reply(&self, word: u16) -> Result<(), FaultKind> {
        taken(self.word(), word)
    }
}

/// `ninter`: ticks between set-points.
#[derive(Debug, Clone, Copy)]
pub struct SetInterval(pub u8);

impl Order for SetInterval {
    type Reply = ();

    const CODE: u8 = 0x07;
    const NAME: &'static str = "SETINT";

    fn word(&self) -> u16 {
        self.0.into()
    }

    fn reply(&self, word: u16) -> Result<(), FaultKind> {
        taken(self.word(), word)
    }
}

/// The largest motor current, in converter counts.
#[derive(Debug, Clone, Copy)]
pub struct Limit(pub i16);

impl Order for Limit {
    type Reply = ();

    const CODE: u8 = 0x08;
    const NAME: &'static str = "SETLIM";

    fn word(&self) -> u16 {
        self.0.cast_unsigned()
    }

    fn reply(&self, word: u16) -> Result<(), FaultKind> {
        taken(self.word(), word)
    }
}

/// Clears all error bits and acknowledges a power-up.
#[derive(Debug, Clone, Copy)]
pub struct Clear;

impl Order for Clear {
    type Reply = ();

    const CODE: u8 = 0x09;
    const NAME: &'static str = "CLEAR";

    fn reply(&self, word: u16) -> Result<(), FaultKind> {
        taken(self.word(), word)
    }
}

/// One byte of the axis processor's memory.
#[derive(Debug, Clone, Copy)]
pub struct DiagRead(pub u8);

impl Order for DiagRead {
    type Reply = u8;

    const CODE: u8 = 0x0A;
    const NAME: &'static str = "DIAGREAD";

    fn word(&self) -> u16 {
        self.0.into()
    }

    /// The reply contains the address, then the byte.
    fn reply(&self, word: u16) -> Result<u8, FaultKind> {
        let [address, byte] = word.to_be_bytes();
        if address == self.0 {
            return Ok(byte);
        }
        Err(FaultKind::Garbled { what: format!("address {address:#04X}, expected {:#04X}", self.0) })
    }
}

/// Writes one byte of the memory: a gain, a tolerance, or an unused address.
#[derive(Debug, Clone, Copy)]
pub struct DiagWrite {
    /// Address, at most [`super::memory::LAST`].
    pub address: u8,
    /// Value to write.
    pub byte: u8,
}

impl Order for DiagWrite {
    type Reply = ();

    const CODE: u8 = 0x0C;
    const NAME: &'static str = "DIAGWRITE";

    fn word(&self) -> u16 {
        u16::from_be_bytes([self.address, self.byte])
    }

    fn reply(&self, word: u16) -> Result<(), FaultKind> {
        taken(self.word(), word)
    }
}

/// Identification data of a servo.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fact {
    /// 0x0560 for a Puma 560.
    Arm = 0,
    /// Counted from 1 at the base.
    Axis = 1,
    /// Serial number of the servo.
    Serial = 2,
    /// Revision of the program in its memory.
    Revision = 3,
}

/// Asks for one identification word.
#[derive(Debug, Clone, Copy)]
pub struct Identify(pub Fact);

impl Order for Identify {
    type Reply = u16;

    const CODE: u8 = 0x0B;
    const NAME: &'static str = "IDENT";

    fn word(&self) -> u16 {
        self.0 as u16
    }

    fn reply(&self, word: u16) -> Result<u16, FaultKind> {
        Ok(word)
    }
}
