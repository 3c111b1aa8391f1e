//! The address of an instrument.

use super::Inside;
use serde::{Deserialize, Serialize};
use std::convert::Infallible;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// `tcp://host:port`; `usb://` and the serial number of a USB device in any socket; or the name of a serial port
/// (`/dev/ttyUSB0`, `COM3`, the path of a pseudo-terminal).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "String", into = "String")]
pub enum Address {
    /// Name of a serial port or pseudo-terminal.
    Serial(String),
    /// Serial number of a USB device.
    Usb(String),
    /// Host and port.
    Tcp(String),
    /// Has no text form: only the code that simulates the instrument can provide it.
    Inside(Inside),
}

impl From<&str> for Address {
    fn from(text: &str) -> Self {
        if let Some(host) = text.strip_prefix("tcp://") {
            return Address::Tcp(host.to_owned());
        }
        match text.strip_prefix("usb://") {
            Some(serial_number) => Address::Usb(serial_number.to_owned()),
            None => Address::Serial(text.to_owned()),
        }
    }
}

impl From<String> for Address {
    fn from(text: String) -> Self {
        text.as_str().into()
    }
}

impl FromStr for Address {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(text.into())
    }
}

impl From<Address> for String {
    fn from(address: Address) -> Self {
        address.to_string()
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Address::Serial(path) => f.write_str(path),
            Address::Usb(serial_number) => write!(f, "usb://{serial_number}"),
            Address::Tcp(host) => write!(f, "tcp://{host}"),
            Address::Inside(inside) => write!(f, "mock:{}", inside.0.name()),
        }
    }
}

/// A port and its line speed. All instruments use 8 data bits, no parity, 1 stop bit and no flow control.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PortSettings {
    /// The port.
    pub address: Address,
    /// Unused for TCP and USB devices.
    pub baud: u32,
    /// File for a record of the whole traffic ([`super::Traffic`]).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub record: Option<PathBuf>,
}

impl PortSettings {
    /// A port without a record of its traffic.
    pub fn new(address: impl Into<Address>, baud: u32) -> Self {
        Self { address: address.into(), baud, record: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_survives_its_text() {
        for text in ["tcp://127.0.0.1:5555", "usb://FT1234", "/dev/ttyUSB0", "COM3"] {
            assert_eq!(Address::from(text).to_string(), text);
        }
        assert_eq!(Address::from("tcp://localhost:5025"), Address::Tcp("localhost:5025".into()));
    }
}
