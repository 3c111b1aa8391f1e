//! The connector of one instrument: it transfers bytes between a wire and the rig, and can simulate faults. A port of
//! the system has its own thread.

#[cfg(unix)]
use super::pty::Pty;
use super::rig::{MockInstrument, Rig};
use super::trouble::{Cable, Trouble};
use super::wire::{Wire, plain};
use crate::transport::{Address, Cord, Inside, Socket};
use std::io::{self, ErrorKind};
use std::net::TcpListener;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Interval at which a thread checks whether it has to end, or its cable is unplugged.
const POLL: Duration = Duration::from_millis(20);
const GLANCE_STREAMING: Duration = Duration::from_micros(200);
/// Largest overrun of a sleep.
const SLEEP_GRAIN: Duration = Duration::from_micros(500);

/// State of one connector, shared by the owner of the bench and the threads.
pub struct Port {
    instrument: MockInstrument,
    address: Mutex<Address>,
    closing: Arc<AtomicBool>,
    /// A cord is plugged in; used for connectors without a port of the system.
    taken: Arc<AtomicBool>,
    line: Line,
}

/// Time of one byte on a line; zero by default, as on a pseudo-terminal.
#[derive(Debug, Clone, Copy, Default)]
pub struct Line {
    byte: Duration,
}

impl Line {
    /// A byte has ten bits: start, eight data bits, stop.
    pub fn paced(baud: u32) -> Self {
        Self { byte: Duration::from_secs_f64(10.0 / f64::from(baud)) }
    }

    /// Returns when `count` bytes are transmitted. They start at once, or after the bytes that occupy the line until
    /// `free`.
    fn carry(self, count: usize, free: &mut Instant) {
        if self.byte.is_zero() {
            return;
        }
        let now = Instant::now();
        *free = now.max(*free) + self.byte * u32::try_from(count).unwrap_or(u32::MAX);
        if let Some(sleep) = free.checked_duration_since(now + SLEEP_GRAIN) {
            std::thread::sleep(sleep);
        }
        while Instant::now() < *free {
            std::hint::spin_loop();
        }
    }
}

pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Port {
    pub fn address(&self) -> Address {
        lock(&self.address).clone()
    }

    pub fn close(&self) {
        self.closing.store(true, Ordering::Release);
    }

    /// Releases the connector of a user that no longer exists.
    pub fn release(&self) {
        self.taken.store(false, Ordering::Release);
    }

    fn is_closing(&self) -> bool {
        self.closing.load(Ordering::Acquire)
    }

    fn is_unplugged(&self, rig: &Mutex<Rig>) -> bool {
        lock(rig).trouble(self.instrument) == Trouble::Unplugged
    }
}

/// Opens a connector and starts its thread.
#[cfg(unix)]
pub fn serve_terminal(
    instrument: MockInstrument,
    rig: Arc<Mutex<Rig>>,
    line: Line,
) -> io::Result<(Arc<Port>, Option<JoinHandle<()>>)> {
    let pty = Pty::open()?;
    let port = Arc::new(Port {
        instrument,
        address: Mutex::new(Address::Serial(pty.path().to_owned())),
        closing: Arc::default(),
        taken: Arc::default(),
        line,
    });
    let shared = Arc::clone(&port);
    let thread = std::thread::Builder::new().name(format!("mock {}", instrument.label())).spawn(move || {
        let mut wire = Some(pty);
        // Keeps the name reserved, so that another bench's port does not get it and is mistaken for this one.
        let mut pulled = Vec::new();
        while !shared.is_closing() {
            if shared.is_unplugged(&rig) {
                pulled.extend(wire.take().map(Pty::pull));
                std::thread::sleep(POLL);
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
                        std::thread::sleep(POLL);
                    }
                }
            }
        }
    })?;
    Ok((port, Some(thread)))
}

/// Listens on a free port of the loopback interface; every client talks to the same instrument.
pub fn serve_tcp(
    instrument: MockInstrument,
    rig: Arc<Mutex<Rig>>,
    line: Line,
) -> io::Result<(Arc<Port>, Option<JoinHandle<()>>)> {
    let listener = TcpListener::bind(("127.0.0.1", 0))?;
    listener.set_nonblocking(true)?;
    let port = Arc::new(Port {
        instrument,
        address: Mutex::new(Address::Tcp(listener.local_addr()?.to_string())),
        closing: Arc::default(),
        taken: Arc::default(),
        line,
    });
    let shared = Arc::clone(&port);
    let thread = std::thread::Builder::new().name(format!("mock {}", instrument.label())).spawn(move || {
        std::thread::scope(|clients| {
            while !shared.is_closing() {
                match listener.accept() {
                    Ok((stream, _)) if !shared.is_unplugged(&rig) => {
                        clients.spawn(|| match plain(&stream) {
                            Ok(()) => converse(&shared, &rig, &mut { stream }),
                            Err(error) => tracing::warn!(%error, "client lost"),
                        });
                    }
                    _ => std::thread::sleep(POLL),
                }
            }
        });
    })?;
    Ok((port, Some(thread)))
}

/// Needs no thread: the instrument runs when its bytes are requested.
pub fn serve_inside(instrument: MockInstrument, rig: Arc<Mutex<Rig>>) -> Arc<Port> {
    let (closing, taken) = (Arc::default(), Arc::default());
    let connector = Connector { instrument, closing: Arc::clone(&closing), taken: Arc::clone(&taken), rig };
    let address = Mutex::new(Address::Inside(Inside(Arc::new(connector))));
    Arc::new(Port { instrument, address, closing, taken, line: Line::default() })
}

/// A connector without a port: code inside this process plugs a cord in.
#[derive(Clone)]
struct Connector {
    instrument: MockInstrument,
    closing: Arc<AtomicBool>,
    taken: Arc<AtomicBool>,
    rig: Arc<Mutex<Rig>>,
}

impl Socket for Connector {
    fn name(&self) -> &str {
        self.instrument.label()
    }

    fn plug(&self) -> io::Result<Box<dyn Cord>> {
        if self.taken.swap(true, Ordering::AcqRel) {
            return Err(io::Error::new(ErrorKind::ResourceBusy, "in use by another instrument"));
        }
        let mut cord = Plugged { connector: self.clone(), talk: Talk::default() };
        cord.write(&[])?;
        Ok(Box::new(cord))
    }
}

struct Plugged {
    connector: Connector,
    talk: Talk,
}

impl Drop for Plugged {
    fn drop(&mut self) {
        self.connector.taken.store(false, Ordering::Release);
    }
}

impl Cord for Plugged {
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let Connector { instrument, closing, rig, .. } = &self.connector;
        if closing.load(Ordering::Acquire) {
            return Err(ErrorKind::BrokenPipe.into());
        }
        self.talk.exchange(*instrument, &mut lock(rig), bytes)
    }

    fn read(&mut self, received: &mut Vec<u8>) -> io::Result<()> {
        self.write(&[])?;
        received.append(&mut self.talk.output);
        Ok(())
    }
}

/// Transfers bytes until the wire fails, is unplugged, or the bench closes.
fn converse(port: &Port, rig: &Mutex<Rig>, wire: &mut impl Wire) {
    let instrument = port.instrument;
    let mut talk = Talk::default();
    let mut free = Instant::now();
    while !port.is_closing() {
        if let Err(error) = talk.carry(port, &mut free, rig, wire) {
            tracing::debug!(%error, instrument = instrument.label(), "client left");
            return;
        }
    }
}

/// One conversation with an instrument: its unprocessed input and its output.
#[derive(Default)]
struct Talk {
    input: Vec<u8>,
    reply: Vec<u8>,
    output: Vec<u8>,
    cable: Cable,
}

impl Talk {
    /// `free`: time when the last byte on the line is transmitted.
    fn carry(&mut self, port: &Port, free: &mut Instant, rig: &Mutex<Rig>, wire: &mut impl Wire) -> io::Result<()> {
        let instrument = port.instrument;
        let mut chunk = [0; 1024];
        let wait = if lock(rig).is_streaming(instrument) { GLANCE_STREAMING } else { POLL };
        let count = wire.receive(&mut chunk, wait)?;
        self.exchange(instrument, &mut lock(rig), &chunk[..count])?;
        if !self.output.is_empty() {
            port.line.carry(count + self.output.len(), free);
            wire.send(&self.output)?;
            self.output.clear();
        }
        Ok(())
    }

    /// Passes `received` to the instrument and returns its output, as the cable transmits it.
    fn exchange(&mut self, instrument: MockInstrument, rig: &mut Rig, received: &[u8]) -> io::Result<()> {
        let trouble = rig.trouble(instrument);
        if trouble == Trouble::Unplugged {
            return Err(ErrorKind::NotConnected.into());
        }
        self.input.extend_from_slice(received);
        if !received.is_empty() {
            rig.receive(instrument, &mut self.input, &mut self.reply);
        }
        rig.unasked(instrument, &mut self.reply);
        self.cable.carry(trouble, &mut self.reply);
        self.output.append(&mut self.reply);
        Ok(())
    }
}
