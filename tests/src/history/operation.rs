//! One operation of one client, and its outcome.

use crate::client::Outcome;
use serde_json::Value;

#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    Start,
    Stop,
    /// With a unique reason.
    Acknowledge {
        reason: String,
    },
    /// `pause`, `resume`, `stop` or `abort`.
    Control,
    MakeToken {
        name: String,
    },
    Revoke {
        name: String,
        secret: String,
    },
    Calibrate,
    /// A note on the client's own run.
    Note {
        run: i64,
        text: String,
    },
    Tag {
        run: i64,
        tag: String,
    },
    Import {
        name: String,
        rows: usize,
    },
}

#[derive(Debug, Clone, PartialEq)]
pub struct Operation {
    /// Name of the client's token.
    pub client: String,
    pub kind: Kind,
    /// Unix time.
    pub sent_s: f64,
    pub ended_s: f64,
    /// [`Outcome::Unknown`] if the client disconnected after the whole request, [`Outcome::NotSent`] if before.
    pub outcome: Outcome,
}

impl Operation {
    pub fn acknowledged(&self) -> Option<&Value> {
        self.outcome.acknowledged()
    }

    /// Whether it may have been executed.
    pub fn possible(&self) -> bool {
        !self.outcome.refused()
    }
}
