//! One operation of one client, and what became of it.

use crate::client::Outcome;
use serde_json::Value;

#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    Start,
    Stop,
    /// With a reason that nobody else gives.
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
    /// Of the client's own run.
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
    /// [`Outcome::Unknown`] where the client hung up behind the whole request, [`Outcome::NotSent`] where it did before.
    pub outcome: Outcome,
}

impl Operation {
    pub fn acknowledged(&self) -> Option<&Value> {
        self.outcome.acknowledged()
    }

    /// It may have been carried out.
    pub fn possible(&self) -> bool {
        !self.outcome.refused()
    }
}
