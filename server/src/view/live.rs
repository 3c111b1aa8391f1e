//! Text frames of the live stream. The binary frames are in [`crate::live::frame`].

use super::{AutopilotState, AutopilotStep, Bench, ChannelInfo, Identified, Note, Progress, RunEvent, RunState, Safe};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// One text frame of `GET /api/v1/events`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum LiveMessage {
    /// A bench has changed; sent for every bench on connection.
    Bench {
        bench: Box<Bench>,
    },
    /// A run has changed its state.
    State {
        bench: String,
        run: i64,
        state: RunState,
        safe: Option<Safe>,
        reason: Option<String>,
    },
    Progress {
        bench: String,
        run: i64,
        progress: Progress,
    },
    /// A new line in a run's journal.
    Event {
        bench: String,
        run: i64,
        event: RunEvent,
    },
    /// A user has written a note about a run.
    Note {
        run: i64,
        note: Note,
    },
    /// The columns of the following binary frames, including `time_s`.
    Channels {
        bench: String,
        run: i64,
        channels: Vec<ChannelInfo>,
    },
    /// A model version was fitted.
    Model {
        run: i64,
        model: i64,
    },
    /// The result of a run has been computed.
    Verdict {
        run: i64,
        verdict: Identified,
    },
    /// User-defined effects of a kind were added, changed or deleted.
    Effects {
        kind: String,
        effect: String,
    },
    /// The queue of a bench has changed.
    Queue {
        bench: String,
    },
    /// An autopilot has completed a step or has ended.
    Autopilot {
        autopilot: i64,
        bench: String,
        state: AutopilotState,
        reason: Option<String>,
        step: Option<Box<AutopilotStep>>,
    },
}
