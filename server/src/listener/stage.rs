//! State of a connection, and the time since which it waits for its client.

use super::Limits;
use std::sync::{Mutex, MutexGuard, PoisonError};
use tokio::time::Instant;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// A request head is arriving, or the TLS handshake before the first one.
    Head,
    /// The body is expected and none of it has arrived.
    Body,
    /// The daemon computes or sends the answer.
    Answer,
    /// Between two requests.
    Idle,
    /// A live stream, without further requests.
    Stream,
}

/// Shared by the parts of one connection.
#[derive(Debug)]
pub struct Progress(Mutex<State>);

#[derive(Debug, Clone, Copy)]
struct State {
    stage: Stage,
    since: Instant,
    /// Time since which the client has accepted no byte.
    stalled: Option<Instant>,
}

impl Progress {
    pub fn begin() -> Self {
        Self(Mutex::new(State { stage: Stage::Head, since: Instant::now(), stalled: None }))
    }

    pub fn enter(&self, stage: Stage) {
        let mut state = self.state();
        if state.stage != stage {
            (state.stage, state.since) = (stage, Instant::now());
        }
    }

    /// The first byte after an idle time starts a head; later bytes belong to it.
    pub fn received(&self) {
        if self.state().stage == Stage::Idle {
            self.enter(Stage::Head);
        }
    }

    pub fn stalls(&self, stalls: bool) {
        let mut state = self.state();
        state.stalled = stalls.then(|| state.stalled.unwrap_or_else(Instant::now));
    }

    /// Time since which the connection waits for its client. `None` if the daemon is working, or for a live stream.
    pub fn waits_since(&self) -> Option<Instant> {
        let state = self.state();
        match state.stage {
            Stage::Stream => None,
            Stage::Answer => state.stalled,
            Stage::Head | Stage::Body | Stage::Idle => Some(state.since),
        }
    }

    /// Whether the client exceeds a time limit. Bodies and answers have separate timers.
    pub fn is_overdue(&self, limits: &Limits) -> bool {
        let state = self.state();
        match state.stage {
            Stage::Head => state.since.elapsed() > limits.head,
            Stage::Idle => state.since.elapsed() > limits.idle,
            Stage::Body | Stage::Answer | Stage::Stream => false,
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
