//! The journal of a run: its events in order, with references to rows.

use crate::state::RunState;
use jointbench_instrument::roles::Identity;
use jointbench_instrument::{Breach, Fault};
use serde::{Deserialize, Serialize};
use std::fmt;
use utoipa::ToSchema;

/// Result of securing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Safe {
    /// Commanded and verified: drive disarmed, shaft at rest, no brake current.
    SafeVerified,
    /// Every command was accepted, but not all of it could be verified.
    SafeCommanded,
    /// An instrument did not accept a command, or contradicts it. A person has to check before the next run.
    UnsafeUnknown,
}

impl Safe {
    /// Every result, the best first.
    pub const ALL: [Safe; 3] = [Safe::SafeVerified, Safe::SafeCommanded, Safe::UnsafeUnknown];

    /// Its name in the store and in REST.
    pub fn name(self) -> &'static str {
        match self {
            Safe::SafeVerified => "safe_verified",
            Safe::SafeCommanded => "safe_commanded",
            Safe::UnsafeUnknown => "unsafe_unknown",
        }
    }
}

/// Controls of a run; all but the last three come from a person.
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
    /// The client of the run is gone: as `Stop`.
    Abandon,
    /// The process that owns the run is terminated: as `Abort`.
    Quit,
    /// The process that stores the run has died: as `Abort`, and the run counts as interrupted.
    StorageLost,
}

/// A control, with the person who requested it if known.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Demand {
    /// The requested action.
    pub control: Control,
    /// Name of the token, or of another source. `None`: not known.
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
    /// What happened.
    #[serde(flatten)]
    pub kind: EventKind,
}

/// What a journal records.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum EventKind {
    /// `reason`: why the run was not completed.
    State {
        /// State that the run has entered.
        state: RunState,
        /// Present if the run does not complete.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        reason: Option<String>,
    },
    /// An instrument answered with its identity before the run.
    Identified {
        /// Name in the bench description.
        instrument: String,
        /// The port at which it answers.
        port: String,
        /// Maker, model, serial number and firmware.
        identity: Identity,
    },
    /// `step` counts from 0. A step that is repeated after a pause gets a new `segment`.
    StepStarted {
        /// Index in the plan, from 0.
        step: usize,
        /// Number in the column `segment`.
        segment: u32,
        /// Number of the repetition of the profile.
        repeat: u32,
        /// The label of the step in the plan.
        label: String,
    },
    /// `late_ticks`: set-points that were sent more than one period after their time.
    StepFinished {
        /// Index in the plan, from 0.
        step: usize,
        /// Number in the column `segment`.
        segment: u32,
        /// Rows of this step.
        rows: u64,
        /// Set-points that were late.
        late_ticks: u64,
    },
    /// A control reached the run.
    Control {
        /// The requested action.
        control: Control,
        /// Who requested it, if known.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        by: Option<String>,
    },
    /// An instrument failed to answer as expected.
    Fault {
        /// Instrument, port and kind of fault.
        fault: Fault,
        /// The second attempt succeeded and the run continues.
        recovered: bool,
    },
    /// A command or sample exceeded a limit, which ends the run.
    Breach {
        /// Quantity, value and limit.
        breach: Breach,
    },
    /// A remark of the engine or of a person.
    Note {
        /// The remark.
        text: String,
    },
    /// A violated precondition of the result, which an identified result shows as a warning.
    Warning {
        /// What is violated, and the consequence.
        text: String,
    },
    /// The bench was secured.
    Safe {
        /// What was verified.
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
