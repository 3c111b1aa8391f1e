//! One instrument's connector: a thread that carries bytes between a wire and the rig, and can be made to misbehave.

#[cfg(unix)]
use super::pty::Pty;
use super::rig::{MockInstrument, Rig};
use super::trouble::{Cable, Trouble};
use super::wire::{Wire, plain};
use crate::transport::Address;
use std::io;
use std::net::TcpListener;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// How soon a thread notices that it shall end, or that its cable is pulled.
const GLANCE: Duration = Duration::from_millis(20);
const GLANCE_STREAMING: Duration = Duration::from_micros(200);

/// What the bench's owner and the threads share about one connector.
pub struct Port {
    instrument: MockInstrument,
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

    pub fn close(&self) {
        self.closing.store(true, Ordering::Release);
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
pub fn serve_terminal(instrument: MockInstrument, rig: Arc<Mutex<Rig>>) -> io::Result<(Arc<Port>, JoinHandle<()>)> {
    let pty = Pty::open()?;
    let port = Arc::new(Port {
        instrument,
        address: Mutex::new(Address::Serial(pty.path().to_owned())),
        closing: AtomicBool::new(false),
    });
    let shared = Arc::clone(&port);
    let thread = std::thread::Builder::new().name(format!("mock {}", instrument.label())).spawn(move || {
        let mut wire = Some(pty);
        while !shared.is_closing() {
            if shared.is_unplugged(&rig) {
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
        address: Mutex::new(Address::Tcp(listener.local_addr()?.to_string())),
        closing: AtomicBool::new(false),
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
                    _ => std::thread::sleep(GLANCE),
                }
            }
        });
    })?;
    Ok((port, thread))
}

/// Carries bytes until the wire breaks, is pulled, or the bench closes.
fn converse(port: &Port, rig: &Mutex<Rig>, wire: &mut impl Wire) {
    let instrument = port.instrument;
    let (mut input, mut output, mut chunk) = (Vec::new(), Vec::new(), [0; 1024]);
    let mut cable = Cable::default();
    let mut wait = GLANCE;
    while !port.is_closing() && !port.is_unplugged(rig) {
        let count = match wire.hear(&mut chunk, wait) {
            Ok(count) => count,
            Err(error) => {
                tracing::debug!(%error, instrument = instrument.label(), "client left");
                return;
            }
        };
        input.extend_from_slice(&chunk[..count]);
        let trouble = {
            let mut rig = lock(rig);
            if count > 0 {
                rig.receive(instrument, &mut input, &mut output);
            }
            rig.unasked(instrument, &mut output);
            wait = if rig.is_streaming(instrument) { GLANCE_STREAMING } else { GLANCE };
            rig.trouble(instrument)
        };
        if trouble == Trouble::Unplugged {
            return;
        }
        cable.carry(trouble, &mut output);
        if !output.is_empty() {
            if let Err(error) = wire.say(&output) {
                tracing::debug!(%error, instrument = instrument.label(), "client left");
                return;
            }
            output.clear();
        }
    }
}
