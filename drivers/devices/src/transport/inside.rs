//! Wires inside this process: to an instrument that it simulates itself, without a port of the system.
//!
//! The bytes are the same as on any other wire. Only the system's part of a round trip is missing, which is the largest
//! part if an instrument answers immediately.

use std::fmt;
use std::io;
use std::sync::Arc;

/// A connector for cords.
pub trait Socket: Send + Sync {
    /// Display name of the connector.
    fn name(&self) -> &str;

    /// A wire to the instrument. Fails if another one is plugged.
    fn plug(&self) -> io::Result<Box<dyn Cord>>;
}

/// One end of a wire. Neither end ever waits.
pub trait Cord: Send {
    /// Sends bytes. Fails if the instrument is unplugged.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Appends the received bytes.
    fn read(&mut self, received: &mut Vec<u8>) -> io::Result<()>;
}

/// A socket as an address. Two addresses are equal if they are the same socket.
#[derive(Clone)]
pub struct Inside(pub Arc<dyn Socket>);

impl PartialEq for Inside {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Eq for Inside {}

impl fmt::Debug for Inside {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Inside({})", self.0.name())
    }
}

/// A cord with its unread bytes.
pub(super) struct Plugged {
    cord: Box<dyn Cord>,
    received: Vec<u8>,
}

impl Plugged {
    pub fn new(inside: &Inside) -> io::Result<Self> {
        Ok(Self { cord: inside.0.plug()?, received: Vec::new() })
    }

    pub fn has_input(&mut self) -> io::Result<bool> {
        self.cord.read(&mut self.received)?;
        Ok(!self.received.is_empty())
    }
}

impl io::Write for Plugged {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.cord.write(bytes)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl io::Read for Plugged {
    /// `WouldBlock` if there is no input.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if !self.has_input()? {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        let count = buffer.len().min(self.received.len());
        buffer[..count].copy_from_slice(&self.received[..count]);
        self.received.drain(..count);
        Ok(count)
    }
}
