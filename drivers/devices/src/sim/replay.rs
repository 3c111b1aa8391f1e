//! Replays a recorded instrument, so that a recorded failure becomes a test.

use super::bench::Transport;
#[cfg(unix)]
use super::pty::Pty;
use super::wire::{Wire, plain};
use crate::transport::{Address, Event, Traffic, shown};
use std::io::{self, ErrorKind};
use std::net::TcpListener;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

const POLL: Duration = Duration::from_millis(20);

/// Answers until it is dropped, as long as the requests match the record.
///
/// Sends recorded replies when all requests before them have arrived, without the recorded delays. A request without a
/// recorded reply gets none, and the driver waits for its own deadline. At a recorded loss of the port the replay
/// disconnects and ends.
pub struct Replay {
    address: Address,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Shared {
    closing: AtomicBool,
    departure: Mutex<Option<String>>,
    done: AtomicBool,
}

impl Replay {
    /// Starts to answer at a new port. [`Transport::Inside`] is not available and becomes TCP.
    pub fn start(traffic: Traffic, transport: Transport) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let inside = Arc::clone(&shared);
        let thread = std::thread::Builder::new().name("replay".into());
        let (address, thread) = match transport {
            #[cfg(unix)]
            Transport::Terminal => {
                let mut pty = Pty::open()?;
                let address = Address::Serial(pty.path().to_owned());
                (address, thread.spawn(move || inside.follow(&traffic, &mut pty))?)
            }
            _ => {
                let listener = TcpListener::bind(("127.0.0.1", 0))?;
                listener.set_nonblocking(true)?;
                let address = Address::Tcp(listener.local_addr()?.to_string());
                (address, thread.spawn(move || inside.accept(&traffic, &listener))?)
            }
        };
        Ok(Self { address, shared, thread: Some(thread) })
    }

    /// The port at which it answers.
    pub fn address(&self) -> &Address {
        &self.address
    }

    /// First deviation of the conversation from the record, or `None`.
    pub fn departure(&self) -> Option<String> {
        self.shared.departure.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The whole record was replayed.
    pub fn is_done(&self) -> bool {
        self.shared.done.load(Ordering::Acquire)
    }
}

impl Drop for Replay {
    fn drop(&mut self) {
        self.shared.closing.store(true, Ordering::Release);
        if self.thread.take().is_some_and(|thread| thread.join().is_err()) {
            tracing::error!("the thread of a replay has panicked");
        }
    }
}

impl Shared {
    fn is_closing(&self) -> bool {
        self.closing.load(Ordering::Acquire)
    }

    fn accept(&self, traffic: &Traffic, listener: &TcpListener) {
        while !self.is_closing() {
            match listener.accept() {
                Ok((mut stream, _)) if plain(&stream).is_ok() => return self.follow(traffic, &mut stream),
                _ => std::thread::sleep(POLL),
            }
        }
    }

    fn follow(&self, traffic: &Traffic, wire: &mut impl Wire) {
        let mut received = Vec::new();
        for (at_s, event) in &traffic.events {
            let followed = match event {
                Event::Received(bytes) => wire.send(bytes),
                Event::Sent(bytes) => self.expect(*at_s, bytes, &mut received, wire),
                Event::Lost => {
                    self.done.store(true, Ordering::Release);
                    return;
                }
            };
            if let Err(error) = followed {
                tracing::debug!(%error, "the replay ends");
                return;
            }
        }
        self.done.store(true, Ordering::Release);
        // Silent from here on, but still plugged in.
        while !self.is_closing() && wire.receive(&mut [0; 256], POLL).is_ok() {}
    }

    fn expect(&self, at_s: f64, bytes: &[u8], received: &mut Vec<u8>, wire: &mut impl Wire) -> io::Result<()> {
        let mut chunk = [0; 1024];
        loop {
            let same = received.iter().zip(bytes).take_while(|(a, b)| a == b).count();
            if same == bytes.len() {
                received.drain(..same);
                return Ok(());
            }
            let departed = same < received.len();
            if departed {
                let what = format!("at {at_s} s of the record: expected {}, heard {}", shown(bytes), shown(received));
                self.departure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(what);
            }
            if self.is_closing() {
                return Err(ErrorKind::Interrupted.into());
            }
            let count = wire.receive(&mut chunk, POLL)?;
            // After a deviation the recorded replies are no longer valid.
            if !departed {
                received.extend_from_slice(&chunk[..count]);
            }
        }
    }
}
