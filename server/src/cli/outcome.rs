//! Title, end and result of a run.

use super::arguments::Run as Arguments;
use super::exit::Exit;
use crate::view::{Identification, Run, RunState, word};

/// Result of the run, or why it is not available.
pub(super) type Found = Result<Identification, Exit>;

pub(super) fn title(arguments: &Arguments) -> String {
    match (&arguments.procedure, arguments.continues) {
        (Some(procedure), _) => procedure.clone(),
        (None, before) => format!("run {} continued", before.unwrap_or_default()),
    }
}

pub(super) fn is_over(state: RunState) -> bool {
    use RunState as S;
    matches!(state, S::Completed | S::Stopped | S::Aborted | S::Failed | S::Interrupted)
}

pub(super) fn ending(run: &Run) -> String {
    let summary = &run.summary;
    let mut text = format!("run {} {}: {} rows", summary.id, word(summary.state), summary.rows);
    if let Some(duration_s) = summary.duration_s {
        text += &format!(" in {duration_s:.1} s of bench time");
    }
    if let Some(safe) = summary.safe {
        text += &format!(", bench {}", word(safe));
    }
    if let Some(reason) = &summary.reason {
        text += &format!(": {reason}");
    }
    if let Some(why) = &summary.not_stored {
        text += &format!("; not yet stored: {why}");
    }
    let can_go_on = jointbench_procedure::procedure(&summary.procedure).is_some_and(|one| one.can_resume().is_ok());
    if can_go_on && is_over(summary.state) && summary.state != RunState::Completed && summary.rows > 0 {
        text += &format!("; complete it with `jointbench run --continue {}`", summary.id);
    }
    text
}
