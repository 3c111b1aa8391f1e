//! Ports with one owner, and links whose waits always end.

mod address;
mod codec;
mod inside;
mod link;
mod ports;
mod traffic;
mod wire;

pub use address::{Address, PortSettings};
pub(crate) use codec::shown;
pub use codec::{Command, Request, Scan};
pub use inside::{Cord, Inside, Socket};
pub use link::Link;
pub use ports::{FoundPort, UsbDevice, ports, why_closed};
pub use traffic::{Event, Recorder, Traffic, TrafficError};
