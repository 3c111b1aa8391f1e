//! The journal of a run: what happened, in order, beside the rows that it tells of.

use crate::state::RunState;
use jointbench_instrument::roles::Identity;
use jointbench_instrument::{Breach, Fault};
use serde::{Deserialize, Serialize};
use std::fmt;

/// What securing has reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Safe {
    /// Commanded and read back: drive disarmed, shaft at rest, no brake current.
    SafeVerified,
    /// Every command was accepted, but not all of it could be read back.
    SafeCommanded,
    /// An instrument took no command or contradicts it. A person has to look before the next run.
    UnsafeUnknown,
}

/// What a run can be asked for, by a person all but the last two.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Control {
    /// Ramp to rest and hold.
    Pause,
    /// Repeat the interrupted step and go on.
    Resume,
    /// Orderly end: the brake is ramped down while the shaft turns, then the shaft comes to rest.
    Stop,
    /// End at once: the shaft ramps down as fast as the plan allows, and the brake's current is taken away behind it, which leaves
    /// poles in the brake.
    Abort,
    /// Drive torque off before anything else.
    #[serde(rename = "estop")]
    EStop,
    /// The program that holds the run is told to end: as `Abort`.
    Quit,
    /// The part of the program that stores the run has died: as `Abort`, and the run counts as interrupted.
    StorageLost,
}

/// What a run is asked for, and by whom, where that is known.
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
    /// Since the start of the run, on the bench's clock; the same zero as `time_s` of the rows.
    pub at_s: f64,
    #[serde(flatten)]
    pub kind: EventKind,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum EventKind {
    /// `reason`: why the run ended, where it was not completed.
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
    /// `late_ticks`: set-points that came more than one period after their time.
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
    /// The run found a precondition of its result broken: an identified result carries this as a warning.
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
