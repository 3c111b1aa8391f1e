//! One type for each telegram that the driver sends.

use super::telegram::{STX, Telegram, command, scan};
use super::{HOST, SENSOR, nack_text};
use crate::transport::{Command, Request, Scan};
use jointbench_instrument::FaultKind;

/// The parameters of an answer of the expected kind from the sensor to the host.
fn answer<const N: usize>(packet: &[u8], expected: u8) -> Result<[u8; N], FaultKind> {
    let telegram = Telegram::decode(packet)?;
    let odd = |what: String| FaultKind::Garbled { what };
    if (telegram.to, telegram.from) != (HOST, SENSOR) {
        return Err(odd(format!(
            "telegram from {:02X} to {:02X}, addressed to another device",
            telegram.from, telegram.to
        )));
    }
    if telegram.command == command::NACK {
        let code = telegram.parameters.first().copied().unwrap_or_default();
        return Err(FaultKind::Refused { what: nack_text(code) });
    }
    if telegram.command != expected {
        return Err(odd(format!("answer {:02X}, expected {expected:02X}", telegram.command)));
    }
    let count = telegram.parameters.len();
    telegram.parameters.try_into().map_err(|_| odd(format!("{count} parameters, expected {N}")))
}

macro_rules! request {
    ($request:ty, $code:expr, $name:literal, $reply:ty, |$this:ident| $parameters:expr, |$self:ident, $packet:ident| $decode:expr) => {
        impl Command for $request {
            fn encode(&self, out: &mut Vec<u8>) {
                let $this = self;
                Telegram::to_sensor($code, $parameters).encode(out);
            }

            fn name(&self) -> String {
                $name.into()
            }
        }

        impl Request for $request {
            type Reply = $reply;

            fn scan(&self, received: &[u8]) -> Scan {
                scan(received)
            }

            fn decode(&$self, $packet: &[u8]) -> Result<$reply, FaultKind> {
                $decode
            }
        }
    };
}

/// Checks whether a sensor answers.
#[derive(Debug, Clone, Copy)]
pub struct Hello;

request!(Hello, command::HELLO, "Hello", (), |_this| &[], |self, packet| {
    answer::<1>(packet, command::HELLO).map(|_| ())
});

/// Both channels at the same moment.
#[derive(Debug, Clone, Copy)]
pub struct ReadRaw;

/// Reply to [`ReadRaw`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawReading {
    /// Converter counts of channels A and B.
    pub raw: [i16; 2],
    /// Calibrated: [`super::NOMINAL_COUNTS`] at nominal torque.
    pub calibrated: [i16; 2],
    /// The sensor shows its 100 % check signal instead of a torque.
    pub check_signal: bool,
}

request!(ReadRaw, command::READ_RAW, "ReadRaw", RawReading, |_this| &[], |self, packet| {
    let p = answer::<9>(packet, command::READ_RAW)?;
    let word = |at: usize| i16::from_be_bytes([p[at], p[at + 1]]);
    Ok(RawReading { raw: [word(0), word(2)], calibrated: [word(4), word(6)], check_signal: p[8] != 0 })
});

/// State of the device: an error code, 0 without an error.
#[derive(Debug, Clone, Copy)]
pub struct ReadStatusShort;

request!(ReadStatusShort, command::READ_STATUS_SHORT, "ReadStatusShort", u8, |_this| &[], |self, packet| {
    answer::<1>(packet, command::READ_STATUS_SHORT).map(|[state]| state)
});

/// 32 bytes of configuration: identifier, data, two checksums of 16 bit.
#[derive(Debug, Clone, Copy)]
pub struct ReadConfig {
    /// Number of the configuration block.
    pub block: u8,
}

/// Reply to [`ReadConfig`]: one block with correct checksums.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ConfigBlock(pub [u8; 32]);

impl ConfigBlock {
    /// Big-endian number of `N` bytes at `offset`.
    pub fn number<const N: usize>(&self, offset: usize) -> u32 {
        self.0[offset..offset + N].iter().fold(0, |value, byte| value << 8 | u32::from(*byte))
    }
}

request!(ReadConfig, command::READ_CONFIG, "ReadConfig", ConfigBlock, |this| &[this.block], |self, packet| {
    let p = answer::<33>(packet, command::READ_CONFIG)?;
    let (sum, weighted) = p[1..29].iter().fold((0u16, 0u16), |(sum, weighted), byte| {
        let sum = sum.wrapping_add(u16::from(*byte));
        (sum, weighted.wrapping_add(sum))
    });
    let block = ConfigBlock(p[1..].try_into().expect("33 bytes less the block number"));
    if p[0] != self.block {
        return Err(FaultKind::Garbled { what: format!("block {}, expected block {}", p[0], self.block) });
    }
    if (block.number::<2>(28), block.number::<2>(30)) != (u32::from(sum), u32::from(weighted)) {
        return Err(FaultKind::Garbled { what: format!("block {}: the block's own checksums are wrong", self.block) });
    }
    Ok(block)
});

/// Both channels at the rate of the sensor's clock, without end (SOSM mode 3). Frames follow the reply, not telegrams.
#[derive(Debug, Clone, Copy)]
pub struct StartStream {
    /// In steps of 200 µs.
    pub period: u8,
}

request!(
    StartStream,
    command::SPECIAL_MODE,
    "GotoSpecialMode",
    (),
    |this| &[3, this.period, 0, 0, b'C'],
    |self, packet| answer::<0>(packet, command::ACK).map(|_| ())
);

/// Ends a running stream: any STX ends it. Three are sent, because one may collide with a byte of the stream.
#[derive(Debug, Clone, Copy)]
pub struct StopStream;

impl Command for StopStream {
    fn encode(&self, out: &mut Vec<u8>) {
        out.extend([STX; 3]);
    }

    fn name(&self) -> String {
        "STX".into()
    }
}
