//! The life of a run: one pure function makes every move.
//!
//! ```text
//! queued → arming → running ⇄ paused
//!    └───────┴─────────┴────────┴──→ securing → completed | stopped | aborted | failed | interrupted
//! ```
//!
//! A final state is reached from `securing` and from nowhere else, so no run can end without the safe state.

use serde::{Deserialize, Serialize};
use std::fmt;
use utoipa::ToSchema;

/// State of a run. The last five are final.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum RunState {
    /// Created, and nothing is commanded yet.
    Queued,
    /// Instruments are identified and the drive is armed.
    Arming,
    /// The steps are performed.
    Running,
    /// At rest; the interrupted step is repeated after `resume`.
    Paused,
    /// The bench is brought to the safe state.
    Securing,
    /// Ended after the last step.
    Completed,
    /// Ended in order, on request.
    Stopped,
    /// Ended at once, on request.
    Aborted,
    /// Ended by a limit, a fault or an error.
    Failed,
    /// Ended because a process died.
    Interrupted,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Every step was done.
    Completed,
    /// A person requested an orderly end.
    Stopped,
    /// A person requested an immediate end.
    Aborted,
    /// A limit, a fault, a full disk or a programming error ended it.
    Failed,
    /// The process that stores the run, or the one that performs it, died during the run.
    Interrupted,
}

impl Outcome {
    /// Every outcome, in the order of the states.
    pub const ALL: [Outcome; 5] =
        [Outcome::Completed, Outcome::Stopped, Outcome::Aborted, Outcome::Failed, Outcome::Interrupted];

    /// The final state of a run with this outcome.
    pub fn state(self) -> RunState {
        match self {
            Outcome::Completed => RunState::Completed,
            Outcome::Stopped => RunState::Stopped,
            Outcome::Aborted => RunState::Aborted,
            Outcome::Failed => RunState::Failed,
            Outcome::Interrupted => RunState::Interrupted,
        }
    }
}

/// Transitions of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Transition {
    /// From `queued`: identify the instruments and arm the drive.
    Arm,
    /// From `arming`: begin the first step.
    Start,
    /// From `running`: ramp to rest.
    Pause,
    /// From `paused`: repeat the interrupted step.
    Resume,
    /// From every state before: bring the bench to the safe state.
    Secure,
    /// From `securing`: reach the final state of the outcome.
    End(Outcome),
}

/// A transition that does not exist in this state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a run that is {from} cannot {transition}")]
pub struct IllegalMove {
    /// State of the run.
    pub from: RunState,
    /// The transition that was tried.
    pub transition: Transition,
}

impl RunState {
    /// Every state, in the order of a run.
    pub const ALL: [RunState; 10] = [
        RunState::Queued,
        RunState::Arming,
        RunState::Running,
        RunState::Paused,
        RunState::Securing,
        RunState::Completed,
        RunState::Stopped,
        RunState::Aborted,
        RunState::Failed,
        RunState::Interrupted,
    ];

    /// The state after a transition.
    pub fn after(self, transition: Transition) -> Result<RunState, IllegalMove> {
        use RunState as S;
        use Transition as T;
        match (self, transition) {
            (S::Queued, T::Arm) => Ok(S::Arming),
            (S::Arming, T::Start) => Ok(S::Running),
            (S::Running, T::Pause) => Ok(S::Paused),
            (S::Paused, T::Resume) => Ok(S::Running),
            (S::Queued | S::Arming | S::Running | S::Paused, T::Secure) => Ok(S::Securing),
            (S::Securing, T::End(outcome)) => Ok(outcome.state()),
            _ => Err(IllegalMove { from: self, transition }),
        }
    }

    /// No transition leads out of this state.
    pub fn is_final(self) -> bool {
        matches!(
            self,
            RunState::Completed | RunState::Stopped | RunState::Aborted | RunState::Failed | RunState::Interrupted
        )
    }

    /// Its name in the store and in REST.
    pub fn name(self) -> &'static str {
        match self {
            RunState::Queued => "queued",
            RunState::Arming => "arming",
            RunState::Running => "running",
            RunState::Paused => "paused",
            RunState::Securing => "securing",
            RunState::Completed => "completed",
            RunState::Stopped => "stopped",
            RunState::Aborted => "aborted",
            RunState::Failed => "failed",
            RunState::Interrupted => "interrupted",
        }
    }
}

impl fmt::Display for RunState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for Transition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Transition::Arm => f.write_str("be armed"),
            Transition::Start => f.write_str("start"),
            Transition::Pause => f.write_str("pause"),
            Transition::Resume => f.write_str("resume"),
            Transition::Secure => f.write_str("be secured"),
            Transition::End(outcome) => write!(f, "become {}", outcome.state()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn transitions() -> Vec<Transition> {
        let plain = [Transition::Arm, Transition::Start, Transition::Pause, Transition::Resume, Transition::Secure];
        plain.into_iter().chain(Outcome::ALL.map(Transition::End)).collect()
    }

    #[test]
    fn every_pair_is_decided() {
        let mut legal = Vec::new();
        for from in RunState::ALL {
            for transition in transitions() {
                match from.after(transition) {
                    Ok(to) => {
                        assert!(!from.is_final(), "{from} is final and moved to {to}");
                        assert!(!to.is_final() || from == RunState::Securing, "{from} ended without securing");
                        legal.push((from, to));
                    }
                    Err(refused) => assert_eq!(refused, IllegalMove { from, transition }),
                }
            }
        }
        assert_eq!(legal.len(), 13, "{legal:?}");
        for state in RunState::ALL.into_iter().filter(|s| *s != RunState::Queued) {
            assert!(legal.iter().any(|(_, to)| *to == state), "{state} cannot be reached");
        }
    }

    #[test]
    fn an_illegal_move_names_the_transition() {
        let refused = RunState::Completed.after(Transition::Resume).unwrap_err();
        assert_eq!(refused.to_string(), "a run that is completed cannot resume");
    }

    proptest! {
        #[test]
        fn any_history_that_ends_was_secured(picks in prop::collection::vec(0usize..10, 0..60)) {
            let transitions = transitions();
            let (mut state, mut secured) = (RunState::Queued, false);
            for pick in picks {
                if let Ok(next) = state.after(transitions[pick]) {
                    secured |= next == RunState::Securing;
                    state = next;
                }
            }
            prop_assert!(!state.is_final() || secured);
        }
    }
}
