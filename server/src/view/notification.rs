//! Messages to other programs and to persons, and their targets.

use super::{Identified, LimitOutcome, RunState};
use crate::config::NotifyEvent;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What a target receives: a webhook and MQTT as JSON, mail as text.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Notification {
    /// The same in a repeated delivery.
    pub id: String,
    /// Word of a [`NotifyEvent`], or `test`.
    pub event: String,
    pub time: String,
    pub bench: Option<String>,
    pub run: Option<i64>,
    pub procedure: Option<String>,
    /// Serial number of the unit under test.
    pub unit: Option<String>,
    pub state: Option<RunState>,
    pub verdict: Option<Identified>,
    pub limits: Option<LimitOutcome>,
    /// One sentence.
    pub summary: String,
    /// Page of the dashboard.
    pub link: Option<String>,
}

/// A target of notifications, without its secrets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NotificationTarget {
    pub name: String,
    /// `webhook`, `mail` or `mqtt`.
    pub kind: String,
    pub events: Vec<NotifyEvent>,
    /// Messages that wait for their delivery.
    pub pending: u64,
    /// Messages of the last days that were not delivered within a day.
    pub failed: u64,
    #[schema(format = DateTime)]
    pub last_delivery: Option<String>,
    /// Error of the last attempt of a message that is not delivered.
    pub last_error: Option<String>,
}

/// Outcome of a test message.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NotificationTest {
    pub name: String,
    pub kind: String,
    /// `null`: the message is delivered.
    pub error: Option<String>,
}
