//! Where a connection is between two requests, and since when it waits for its client.

use super::Limits;
use std::sync::{Mutex, MutexGuard, PoisonError};
use tokio::time::Instant;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// The head of a request is on its way, or the handshake of TLS before the first one.
    Head,
    /// The body is on its way and nothing of it has come yet.
    Body,
    /// The daemon works on the answer or sends it.
    Answer,
    /// Between two requests.
    Idle,
    /// A live stream: no requests any more.
    Stream,
}

/// Shared by the parts of one connection.
#[derive(Debug)]
pub struct Progress(Mutex<State>);

#[derive(Debug, Clone, Copy)]
struct State {
    stage: Stage,
    since: Instant,
    /// Since when the client has accepted no byte of what is sent.
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

    /// The first byte after a pause begins a head; later ones belong to it.
    pub fn heard(&self) {
        if self.state().stage == Stage::Idle {
            self.enter(Stage::Head);
        }
    }

    pub fn stalls(&self, stalls: bool) {
        let mut state = self.state();
        state.stalled = stalls.then(|| state.stalled.unwrap_or_else(Instant::now));
    }

    /// Since when the client keeps this connection waiting. `None`: the daemon is at work, or it is a live stream.
    pub fn waits_since(&self) -> Option<Instant> {
        let state = self.state();
        match state.stage {
            Stage::Stream => None,
            Stage::Answer => state.stalled,
            Stage::Head | Stage::Body | Stage::Idle => Some(state.since),
        }
    }

    /// The client has taken longer than it may. Bodies and answers have clocks of their own.
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
