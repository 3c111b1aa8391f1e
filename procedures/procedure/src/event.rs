//! The journal of a run: its events in order, with references to rows.

use crate::state::RunState;
use jointbench_instrument::roles::Identity;
use jointbench_instrument::{Breach, Fault};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Result of securing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Safe {
    /// Commanded and verified: drive disarmed, shaft at rest, no brake current.
    SafeVerified,
    /// Every command was accepted, but not all of it could be verified.
    SafeCommanded,
    /// An instrument did not accept a command, or contradicts it. A person has to check before the next run.
    UnsafeUnknown,
}

/// Controls of a run; all but the last two come from a person.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Control {
    /// Ramps to rest and holds.
    Pause,
    /// Repeats the interrupted step and continues.
    Resume,
    /// Orderly end: the brake is ramped down during rotation, then the shaft stops.
    Stop,
    /// Immediate end: the shaft ramps down as fast as the plan permits, and the brake current is removed after that,
    /// which leaves poles in the brake.
    Abort,
    /// Drive torque off first.
    #[serde(rename = "estop")]
    EStop,
    /// The process that owns the run is terminated: as `Abort`.
    Quit,
    /// The process that stores the run has died: as `Abort`, and the run counts as interrupted.
    StorageLost,
}

/// A control, with the person who requested it if known.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Demand {
    pub control: Control,
    pub by: Option<String>,
}

impl From<Control> for Demand {
    fn from(control: Control) -> Self {
        Self { control, by: None }
    }
}

/// One entry of the journal. The store adds the sequence number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Time since the start of the run, on the bench's clock; the same zero as `time_s` of the rows.
    pub at_s: f64,
    #[serde(flatten)]
    pub kind: EventKind,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum EventKind {
    /// `reason`: why the run was not completed.
    State {
        state: RunState,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        reason: Option<String>,
    },
    Identified {
        instrument: String,
        port: String,
        identity: Identity,
    },
    /// `step` counts from 0. A step that is repeated after a pause gets a new `segment`.
    StepStarted {
        step: usize,
        segment: u32,
        repeat: u32,
        label: String,
    },
    /// `late_ticks`: set-points that were sent more than one period after their time.
    StepFinished {
        step: usize,
        segment: u32,
        rows: u64,
        late_ticks: u64,
    },
    Control {
        control: Control,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        by: Option<String>,
    },
    Fault {
        fault: Fault,
        recovered: bool,
    },
    Breach {
        breach: Breach,
    },
    Note {
        text: String,
    },
    /// A violated precondition of the result, which an identified result shows as a warning.
    Warning {
        text: String,
    },
    Safe {
        safe: Safe,
    },
}

impl fmt::Display for Safe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Safe::SafeVerified => "safe state verified",
            Safe::SafeCommanded => "safe state commanded, not verified",
            Safe::UnsafeUnknown => "safe state not confirmed",
        })
    }
}
