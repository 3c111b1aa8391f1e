//! One open port: a serial port held exclusively, a TCP stream, or an instrument in this process. Reads return chunks;
//! no call blocks past its deadline.

use super::inside::Plugged;
use super::ports::path_of;
use super::{Address, PortSettings};
use jointbench_instrument::FaultKind;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

#[cfg(unix)]
type NativePort = serialport::TTYPort;
#[cfg(windows)]
type NativePort = serialport::COMPort;

const CONNECT_TIMEOUT: Duration = Duration::from_secs(2);

pub enum Wire {
    Serial(NativePort),
    Tcp(TcpStream),
    Inside(Plugged),
}

/// Polling interval while waiting for an instrument in this process: another thread may advance its time.
const POLL: Duration = Duration::from_micros(200);

impl Wire {
    pub fn open(settings: &PortSettings) -> Result<Self, FaultKind> {
        match &settings.address {
            Address::Serial(path) => open_serial(path, settings.baud),
            Address::Usb(serial_number) => open_serial(&path_of(serial_number)?, settings.baud),
            Address::Tcp(host) => open_tcp(host).map_err(not_opened),
            Address::Inside(inside) => Plugged::new(inside).map(Wire::Inside).map_err(not_opened),
        }
    }

    /// Writes all of `bytes`. An error of kind `TimedOut` after the deadline.
    pub fn write(&mut self, mut bytes: &[u8], deadline: Instant) -> io::Result<()> {
        while !bytes.is_empty() {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(ErrorKind::TimedOut.into());
            }
            match self.set_timeout(left).and_then(|()| self.io().write(bytes)) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(count) => bytes = &bytes[count..],
                Err(error) if is_wait_over(&error) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Received bytes as soon as there are any. `Ok(0)` after the deadline.
    ///
    /// The port's own time-out only limits one wait. It may end early, so the deadline is checked again.
    pub fn read(&mut self, buffer: &mut [u8], deadline: Instant) -> io::Result<usize> {
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(0);
            }
            match self.set_timeout(left).and_then(|()| self.io().read(buffer)) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(count) => return Ok(count),
                Err(error) if is_wait_over(&error) => {
                    if let Wire::Inside(_) = self {
                        std::thread::sleep(POLL.min(left));
                    }
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// Whether unread bytes are available. Does not wait.
    pub fn has_input(&mut self) -> io::Result<bool> {
        match self {
            Wire::Serial(port) => Ok(serialport::SerialPort::bytes_to_read(port)? > 0),
            Wire::Tcp(stream) => {
                stream.set_nonblocking(true)?;
                let peeked = stream.peek(&mut [0]);
                stream.set_nonblocking(false)?;
                match peeked {
                    Err(error) if is_wait_over(&error) => Ok(false),
                    // `read` reports the end of the stream.
                    result => result.map(|_| true),
                }
            }
            Wire::Inside(plugged) => plugged.has_input(),
        }
    }

    fn io(&mut self) -> &mut dyn ReadWrite {
        match self {
            Wire::Serial(port) => port,
            Wire::Tcp(stream) => stream,
            Wire::Inside(plugged) => plugged,
        }
    }

    fn set_timeout(&mut self, timeout: Duration) -> io::Result<()> {
        match self {
            Wire::Serial(port) => serialport::SerialPort::set_timeout(port, timeout).map_err(io::Error::from),
            Wire::Tcp(stream) => {
                stream.set_read_timeout(Some(timeout))?;
                stream.set_write_timeout(Some(timeout))
            }
            Wire::Inside(_) => Ok(()),
        }
    }
}

trait ReadWrite: Read + Write {}
impl<T: Read + Write> ReadWrite for T {}

#[cfg(unix)]
impl Drop for Wire {
    /// A terminal keeps its exclusive mark while any process has it open, such as the simulator of a pseudo-terminal.
    fn drop(&mut self) {
        if let Wire::Serial(port) = self
            && let Err(error) = port.set_exclusive(false)
        {
            tracing::debug!(%error, "exclusive access not given back");
        }
    }
}

fn is_wait_over(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

fn not_opened(error: io::Error) -> FaultKind {
    FaultKind::NotOpened { what: error.to_string() }
}

fn open_serial(path: &str, baud: u32) -> Result<Wire, FaultKind> {
    let opened = serialport::new(path, baud).open_native();
    opened.map(Wire::Serial).map_err(|error| {
        let cure = match error.kind() {
            serialport::ErrorKind::Io(ErrorKind::PermissionDenied) => "; add the user to the group that owns the port",
            serialport::ErrorKind::NoDevice => "; check that it is connected and not in use by another program",
            _ => "",
        };
        FaultKind::NotOpened { what: format!("{error}{cure}") }
    })
}

fn open_tcp(host: &str) -> io::Result<Wire> {
    let mut last = io::Error::new(ErrorKind::NotFound, "the host has no address");
    for address in host.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT_TIMEOUT) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                return Ok(Wire::Tcp(stream));
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}
