//! Wires within this process: to an instrument that it simulates itself, without a port of the system between them.
//!
//! The bytes are those of any other wire. What falls away is the system's share of a round trip, which is most of it where
//! an instrument answers at once.

use std::fmt;
use std::io;
use std::sync::Arc;

/// Where cords are plugged in.
pub trait Socket: Send + Sync {
    /// For people: where the instrument sits.
    fn name(&self) -> &str;

    fn plug(&self) -> io::Result<Box<dyn Cord>>;
}

/// One end of a wire. Neither end ever waits.
pub trait Cord: Send {
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Appends what has come in.
    fn read(&mut self, received: &mut Vec<u8>) -> io::Result<()>;
}

/// A socket as an address. Two are equal when they are the same one.
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

/// A cord with the bytes that nobody has read yet.
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
    /// `WouldBlock` where nothing has come in.
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
