//! Why a run ends, how fast it has to be secured, and the text for users.

use crate::event::EventKind;
use crate::guard::Refusal;
use crate::recorder::RecorderFault;
use crate::state::{IllegalMove, Outcome};
use jointbench_instrument::Fault;
use std::fmt;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Ending {
    Completed,
    Stopped,
    /// All senders of controls were dropped.
    Abandoned,
    Aborted,
    EStopped,
    /// The process that owns the run was terminated.
    Quit,
    /// The process that stores the run has died.
    StorageLost,
    /// Arming found a reason not to move.
    NotReady(String),
    /// The guard rejected a command before it was sent.
    CommandRefused(Refusal),
    /// The guard rejected a sample.
    SampleRefused(Refusal),
    JointFault(Fault),
    /// A fault of another instrument: the joint still obeys.
    OtherFault(Fault),
    Unrecorded(RecorderFault),
    Panicked(String),
    Illegal(IllegalMove),
}

impl Ending {
    /// The fault of an instrument.
    pub fn fault_mut(&mut self) -> Option<&mut Fault> {
        match self {
            Ending::JointFault(fault) | Ending::OtherFault(fault) => Some(fault),
            _ => None,
        }
    }
}

/// Time that securing may take, from most to least.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Urgency {
    /// Unloads the brake during rotation, then stops the shaft.
    Orderly,
    /// The shaft ramps down, and the brake current is removed after that.
    Quick,
    /// Drive torque off first.
    Cut,
}

impl Ending {
    pub fn outcome(&self) -> Outcome {
        match self {
            Ending::Completed => Outcome::Completed,
            Ending::Stopped | Ending::Abandoned => Outcome::Stopped,
            Ending::Aborted | Ending::EStopped | Ending::Quit => Outcome::Aborted,
            Ending::StorageLost => Outcome::Interrupted,
            _ => Outcome::Failed,
        }
    }

    pub fn urgency(&self) -> Urgency {
        match self {
            Ending::Completed | Ending::Stopped | Ending::Abandoned | Ending::Unrecorded(_) => Urgency::Orderly,
            Ending::Aborted
            | Ending::Quit
            | Ending::StorageLost
            | Ending::CommandRefused(_)
            | Ending::OtherFault(_) => Urgency::Quick,
            Ending::EStopped
            | Ending::NotReady(_)
            | Ending::SampleRefused(_)
            | Ending::JointFault(_)
            | Ending::Panicked(_)
            | Ending::Illegal(_) => Urgency::Cut,
        }
    }

    pub fn reason(&self) -> Option<String> {
        (!matches!(self, Ending::Completed)).then(|| self.to_string())
    }

    /// The journal entry of the ending. Instrument faults were already reported when they occurred.
    pub fn event(&self) -> Option<EventKind> {
        match self {
            Ending::Completed | Ending::JointFault(_) | Ending::OtherFault(_) => None,
            Ending::CommandRefused(Refusal::Breach(breach)) | Ending::SampleRefused(Refusal::Breach(breach)) => {
                Some(EventKind::Breach { breach: *breach })
            }
            other => Some(EventKind::Note { text: other.to_string() }),
        }
    }
}

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Ending::Completed => f.write_str("completed"),
            Ending::Stopped => f.write_str("stopped by the operator"),
            Ending::Abandoned => f.write_str("stopped because no client controlled the run"),
            Ending::Aborted => f.write_str("aborted by the operator"),
            Ending::EStopped => f.write_str("software stop pressed"),
            Ending::Quit => f.write_str("aborted because the daemon was shut down"),
            Ending::StorageLost => {
                f.write_str("the daemon terminated during the run; the bench worker secured the bench")
            }
            Ending::NotReady(why) => write!(f, "not started: {why}"),
            Ending::CommandRefused(refusal) => write!(f, "command refused: {refusal}"),
            Ending::SampleRefused(refusal) => write!(f, "limit exceeded: {refusal}"),
            Ending::JointFault(fault) | Ending::OtherFault(fault) => fault.fmt(f),
            Ending::Unrecorded(fault) => fault.fmt(f),
            Ending::Panicked(what) => write!(f, "internal error, please report it: {what}"),
            Ending::Illegal(illegal) => write!(f, "internal error, please report it: {illegal}"),
        }
    }
}

impl From<RecorderFault> for Ending {
    fn from(fault: RecorderFault) -> Self {
        Ending::Unrecorded(fault)
    }
}
