//! One instrument's connector: a thread that carries bytes between a wire and the rig, and can be made to misbehave.

#[cfg(unix)]
use super::pty::Pty;
use super::rig::{MockInstrument, Rig};
use crate::transport::Address;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// How soon a thread notices that it shall end, or that its trouble has changed.
const GLANCE: Duration = Duration::from_millis(20);
const GLANCE_STREAMING: Duration = Duration::from_millis(1);

/// A bad day of one instrument.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Trouble {
    #[default]
    None,
    /// Hears and does what it is told, but its replies are lost.
    Silent,
    /// Replies are held back until the trouble ends, and come all at once then.
    Late,
    /// One byte of every reply is wrong.
    Garbled,
    /// The cable is out. A pseudo-terminal comes back under another name, a TCP port under the same.
    Unplugged,
}

/// What the bench's owner and the threads share about one connector.
pub struct Port {
    instrument: MockInstrument,
    trouble: Mutex<Trouble>,
    address: Mutex<Address>,
    closing: AtomicBool,
}

pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Port {
    pub fn address(&self) -> Address {
        lock(&self.address).clone()
    }

    pub fn set_trouble(&self, trouble: Trouble) {
        *lock(&self.trouble) = trouble;
    }

    pub fn close(&self) {
        self.closing.store(true, Ordering::Release);
    }

    fn is_closing(&self) -> bool {
        self.closing.load(Ordering::Acquire)
    }

    fn trouble(&self) -> Trouble {
        *lock(&self.trouble)
    }
}

/// Opens a connector and starts its thread.
#[cfg(unix)]
pub fn serve_terminal(instrument: MockInstrument, rig: Arc<Mutex<Rig>>) -> io::Result<(Arc<Port>, JoinHandle<()>)> {
    let pty = Pty::open()?;
    let port = Arc::new(Port {
        instrument,
        trouble: Mutex::default(),
        address: Mutex::new(Address::Serial(pty.path().to_owned())),
        closing: AtomicBool::new(false),
    });
    let shared = Arc::clone(&port);
    let thread = std::thread::Builder::new().name(format!("mock {}", instrument.label())).spawn(move || {
        let mut wire = Some(pty);
        while !shared.is_closing() {
            if shared.trouble() == Trouble::Unplugged {
                wire = None;
                std::thread::sleep(GLANCE);
            } else if let Some(wire) = &mut wire {
                converse(&shared, &rig, wire);
            } else {
                match Pty::open() {
                    Ok(pty) => {
                        *lock(&shared.address) = Address::Serial(pty.path().to_owned());
                        wire = Some(pty);
                    }
                    Err(error) => {
                        tracing::error!(%error, instrument = shared.instrument.label(), "no pseudo-terminal");
                        std::thread::sleep(GLANCE);
                    }
                }
            }
        }
    })?;
    Ok((port, thread))
}

/// Listens on a free port of the loopback interface; every client talks to the same instrument.
pub fn serve_tcp(instrument: MockInstrument, rig: Arc<Mutex<Rig>>) -> io::Result<(Arc<Port>, JoinHandle<()>)> {
    let listener = TcpListener::bind(("127.0.0.1", 0))?;
    listener.set_nonblocking(true)?;
    let port = Arc::new(Port {
        instrument,
        trouble: Mutex::default(),
        address: Mutex::new(Address::Tcp(listener.local_addr()?.to_string())),
        closing: AtomicBool::new(false),
    });
    let shared = Arc::clone(&port);
    let thread = std::thread::Builder::new().name(format!("mock {}", instrument.label())).spawn(move || {
        std::thread::scope(|clients| {
            while !shared.is_closing() {
                match listener.accept() {
                    Ok((stream, _)) if shared.trouble() != Trouble::Unplugged => {
                        clients.spawn(|| match plain(&stream) {
                            Ok(()) => converse(&shared, &rig, &mut { stream }),
                            Err(error) => tracing::warn!(%error, "client lost"),
                        });
                    }
                    _ => std::thread::sleep(GLANCE),
                }
            }
        });
    })?;
    Ok((port, thread))
}

fn plain(stream: &TcpStream) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)
}

trait Cable {
    /// `Ok(0)`: nothing came within `wait`.
    fn hear(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<usize>;
    fn say(&mut self, bytes: &[u8]) -> io::Result<()>;
}

#[cfg(unix)]
impl Cable for Pty {
    fn hear(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
        self.read(buffer, wait)
    }

    fn say(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.write(bytes)
    }
}

impl Cable for TcpStream {
    fn hear(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
        self.set_read_timeout(Some(wait))?;
        match self.read(buffer) {
            Ok(0) => Err(ErrorKind::UnexpectedEof.into()),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => Ok(0),
            result => result,
        }
    }

    fn say(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.write_all(bytes)
    }
}

/// Carries bytes until the cable breaks, is pulled, or the bench closes.
fn converse(port: &Port, rig: &Mutex<Rig>, cable: &mut impl Cable) {
    let instrument = port.instrument;
    let (mut input, mut output, mut held, mut chunk) = (Vec::new(), Vec::new(), Vec::new(), [0; 1024]);
    let mut wait = GLANCE;
    while !port.is_closing() && port.trouble() != Trouble::Unplugged {
        let count = match cable.hear(&mut chunk, wait) {
            Ok(count) => count,
            Err(error) => {
                tracing::debug!(%error, instrument = instrument.label(), "client left");
                return;
            }
        };
        input.extend_from_slice(&chunk[..count]);
        {
            let mut rig = lock(rig);
            if count > 0 {
                rig.receive(instrument, &mut input, &mut output);
            }
            rig.unasked(instrument, &mut output);
            wait = if rig.is_streaming(instrument) { GLANCE_STREAMING } else { GLANCE };
        }
        match port.trouble() {
            Trouble::Silent => output.clear(),
            Trouble::Late => held.append(&mut output),
            // The middle of a line or telegram; a flipped high bit is wrong in each of the protocols.
            Trouble::Garbled => {
                let middle = output.len() / 2;
                if let Some(byte) = output.get_mut(middle) {
                    *byte ^= 0x40;
                }
            }
            Trouble::None => drop(output.splice(0..0, held.drain(..))),
            Trouble::Unplugged => {}
        }
        if !output.is_empty() {
            if let Err(error) = cable.say(&output) {
                tracing::debug!(%error, instrument = instrument.label(), "client left");
                return;
            }
            output.clear();
        }
    }
}
