//! A link: one instrument, one port, one owner. Request and reply with our own deadline.

use super::codec::shown;
use super::wire::Wire;
use super::{Command, PortSettings, Recorder, Request, Scan};
use jointbench_instrument::{Fault, FaultKind, LatencyCounter};
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Silence after which a line counts as drained.
const QUIET: Duration = Duration::from_millis(20);
/// More than any reply of any instrument: a longer input is noise.
const MAX_PENDING: usize = 4096;

/// Limit of one call of [`Link::receive_unrequested`]: a flooded line must not block its owner.
const MAX_UNREQUESTED: usize = 1 << 16;

/// Whether the next reply belongs to the next request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Trust {
    Trusted,
    /// A reply was missing or garbled: drain and identify before use.
    Stale,
    /// The port is lost: open it again, drain and identify.
    Lost,
}

/// An exclusively opened port to one instrument: requests with deadlines, and the trust in its replies.
pub struct Link {
    instrument: String,
    settings: PortSettings,
    address: String,
    deadline: Duration,
    wire: Option<Wire>,
    recorder: Option<Recorder>,
    trust: Trust,
    /// The last exchange failed. The next replies get less than a deadline, so that a fault is known within two
    /// deadlines.
    missed: bool,
    /// Durations of the exchanges.
    latency: Arc<LatencyCounter>,
    outgoing: Vec<u8>,
    received: Vec<u8>,
}

impl Link {
    /// Opens the port exclusively. The link is not trusted before [`Link::trust`].
    pub fn open(instrument: &str, settings: &PortSettings, deadline: Duration) -> Result<Self, Fault> {
        let address = settings.address.to_string();
        let wire = Wire::open(settings).map_err(|kind| kind.at(instrument, &address))?;
        let mut link = Self {
            instrument: instrument.to_owned(),
            settings: settings.clone(),
            address,
            deadline,
            wire: Some(wire),
            recorder: None,
            trust: Trust::Stale,
            missed: false,
            latency: Arc::default(),
            outgoing: Vec::with_capacity(256),
            received: Vec::with_capacity(256),
        };
        link.record(settings.record.as_deref())?;
        Ok(link)
    }

    /// Records the traffic in a new file from now on; `None` ends the recording. The record starts with a drain and an
    /// identification, as every replay does.
    pub fn record(&mut self, file: Option<&Path>) -> Result<(), Fault> {
        let recorder = file.map(|path| {
            Recorder::create(path, &self.instrument, &self.address).map_err(|error| {
                let what = format!("traffic cannot be recorded in {}: {error}", path.display());
                self.fault(FaultKind::NotOpened { what })
            })
        });
        self.recorder = recorder.transpose()?;
        if self.recorder.is_some() {
            self.distrust();
        }
        Ok(())
    }

    /// Name of the instrument in faults.
    pub fn instrument(&self) -> &str {
        &self.instrument
    }

    /// The port in text form.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Longest time for a reply.
    pub fn deadline(&self) -> Duration {
        self.deadline
    }

    /// Counts every request that was sent, until its reply or its deadline.
    pub fn latency_counter(&self) -> Arc<LatencyCounter> {
        Arc::clone(&self.latency)
    }

    /// Replies belong to requests; otherwise the link must be drained and the instrument identified.
    pub(crate) fn is_trusted(&self) -> bool {
        self.trust == Trust::Trusted
    }

    /// The instrument is identified: replies belong to requests again.
    pub fn trust(&mut self) {
        self.trust = Trust::Trusted;
        self.missed = false;
    }

    /// The next reply may belong to another request: drain and identify before the next request.
    pub(crate) fn distrust(&mut self) {
        if self.trust == Trust::Trusted {
            self.trust = Trust::Stale;
        }
    }

    /// Appends the received bytes to `bytes`, for instruments that send without a request. Waits at most `wait` for
    /// the first byte; returns the number of bytes.
    pub(crate) fn receive_unrequested(&mut self, bytes: &mut Vec<u8>, wait: Duration) -> Result<usize, Fault> {
        let before = bytes.len();
        bytes.append(&mut self.received);
        let mut until = Instant::now() + wait;
        loop {
            let count = self.next_chunk(until).map_err(|kind| self.broken(kind))?;
            bytes.append(&mut self.received);
            if count == 0 || bytes.len() - before >= MAX_UNREQUESTED {
                return Ok(bytes.len() - before);
            }
            until = Instant::now();
        }
    }

    /// Writes a command that has no reply. Also on a stale link, because a stop command must not wait.
    pub fn send(&mut self, command: &impl Command) -> Result<(), Fault> {
        let deadline = Instant::now() + self.deadline;
        self.outgoing.clear();
        command.encode(&mut self.outgoing);
        self.write(deadline).map_err(|kind| self.broken(kind))
    }

    /// Request and reply on a trusted link. Any failure makes the link stale.
    pub fn request<R: Request>(&mut self, request: &R) -> Result<R::Reply, Fault> {
        if self.trust != Trust::Trusted {
            let what = format!("{} asked before the link was drained and the instrument identified", request.name());
            return Err(self.fault(FaultKind::Garbled { what }));
        }
        self.probe(request)
    }

    /// Request and reply in any state of the link, for identification.
    pub fn probe<R: Request>(&mut self, request: &R) -> Result<R::Reply, Fault> {
        let deadline = Instant::now() + self.reply_deadline();
        self.exchange(request, deadline).map_err(|kind| self.broken(kind))
    }

    /// Opens a lost port again, sends `wake` to end an incomplete line or telegram, and discards received bytes until
    /// the line is quiet. `answered`: `wake` itself has a reply, which is awaited.
    pub fn drain(&mut self, wake: &[u8], answered: bool) -> Result<(), Fault> {
        self.received.clear();
        if self.trust == Trust::Lost {
            self.wire = None;
            self.wire = Some(Wire::open(&self.settings).map_err(|kind| self.fault(kind))?);
        }
        self.trust = Trust::Stale;
        let deadline = Instant::now() + self.deadline;
        self.outgoing.clear();
        self.outgoing.extend_from_slice(wake);
        self.discard(deadline, answered).map_err(|kind| self.broken(kind))
    }

    /// A fault of this instrument at this port.
    pub fn fault(&self, kind: FaultKind) -> Fault {
        kind.at(&self.instrument, &self.address)
    }

    fn exchange<R: Request>(&mut self, request: &R, deadline: Instant) -> Result<R::Reply, FaultKind> {
        let start = Instant::now();
        self.next_chunk(start)?;
        if !self.received.is_empty() {
            return Err(FaultKind::Garbled { what: format!("{} without a request", shown(&self.received)) });
        }
        self.outgoing.clear();
        request.encode(&mut self.outgoing);
        self.write(deadline)?;
        let reply = self.reply(request, deadline);
        self.latency.add(start.elapsed());
        reply
    }

    fn reply<R: Request>(&mut self, request: &R, deadline: Instant) -> Result<R::Reply, FaultKind> {
        loop {
            match request.scan(&self.received) {
                Scan::Packet { length } => {
                    let reply = request.decode(&self.received[..length]);
                    self.received.drain(..length);
                    return reply;
                }
                Scan::Noise { skip } => {
                    tracing::debug!(instrument = %self.instrument, bytes = %shown(&self.received[..skip]), "noise");
                    self.received.drain(..skip);
                }
                Scan::Short if self.received.len() > MAX_PENDING => {
                    return Err(FaultKind::Garbled { what: format!("{} bytes without an end", self.received.len()) });
                }
                Scan::Short => {
                    if self.read(deadline)? == 0 {
                        return Err(self.no_reply(request.name()));
                    }
                }
            }
        }
    }

    fn reply_deadline(&self) -> Duration {
        if self.missed { self.second_chance() } else { self.deadline }
    }

    /// Time for each of two more replies after a missed deadline: the instrument is given up within two deadlines in
    /// total.
    fn second_chance(&self) -> Duration {
        self.deadline * 2 / 5
    }

    fn no_reply(&self, request: String) -> FaultKind {
        if self.received.is_empty() {
            FaultKind::Silent { request, deadline_ms: self.reply_deadline().as_millis() as u64 }
        } else {
            FaultKind::Garbled { what: format!("{} and no more", shown(&self.received)) }
        }
    }

    fn discard(&mut self, deadline: Instant, answered: bool) -> Result<(), FaultKind> {
        self.write(deadline)?;
        let mut wait = if answered { self.second_chance() } else { QUIET };
        while Instant::now() < deadline {
            if self.read(deadline.min(Instant::now() + wait))? == 0 {
                return Ok(());
            }
            self.received.clear();
            wait = QUIET;
        }
        Err(FaultKind::Garbled { what: "the line does not become idle".into() })
    }

    fn write(&mut self, deadline: Instant) -> Result<(), FaultKind> {
        let wire = self.wire.as_mut().ok_or_else(port_is_closed)?;
        if let Some(recorder) = &mut self.recorder {
            recorder.sent(&self.outgoing);
        }
        wire.write(&self.outgoing, deadline).map_err(lost)
    }

    /// Bytes that are already received, or else bytes that arrive before `until`.
    fn next_chunk(&mut self, until: Instant) -> Result<usize, FaultKind> {
        let now = Instant::now();
        if until > now {
            return self.read(until);
        }
        let wire = self.wire.as_mut().ok_or_else(port_is_closed)?;
        // Bytes are available, so this read does not wait.
        if wire.has_input().map_err(lost)? { self.read(now + QUIET) } else { Ok(0) }
    }

    fn read(&mut self, deadline: Instant) -> Result<usize, FaultKind> {
        let mut chunk = [0; 512];
        let wire = self.wire.as_mut().ok_or_else(port_is_closed)?;
        let count = wire.read(&mut chunk, deadline).map_err(lost)?;
        if let Some(recorder) = &mut self.recorder {
            recorder.received(&chunk[..count]);
        }
        self.received.extend_from_slice(&chunk[..count]);
        Ok(count)
    }

    /// Updates the state of the link after a failed exchange.
    fn broken(&mut self, kind: FaultKind) -> Fault {
        let lost = matches!(kind, FaultKind::Disconnected { .. } | FaultKind::NotOpened { .. });
        if let (true, Some(recorder)) = (lost && self.trust != Trust::Lost, &mut self.recorder) {
            recorder.lost();
        }
        self.trust = if lost { Trust::Lost } else { Trust::Stale };
        self.missed = true;
        self.fault(kind)
    }
}

fn lost(error: io::Error) -> FaultKind {
    if error.kind() == io::ErrorKind::TimedOut {
        return FaultKind::Garbled { what: "the line accepts no more bytes".into() };
    }
    FaultKind::Disconnected { what: error.to_string() }
}

fn port_is_closed() -> FaultKind {
    FaultKind::Disconnected { what: "the port is closed".into() }
}
