//! Title and result of a run.

use super::arguments::Run as Arguments;
use super::exit::Exit;
use crate::view::Identification;

/// Result of the run, or why it is not available.
pub(super) type Found = Result<Identification, Exit>;

pub(super) fn title(arguments: &Arguments) -> String {
    match (&arguments.procedure, arguments.continues) {
        (Some(procedure), _) => procedure.clone(),
        (None, before) => format!("run {} continued", before.unwrap_or_default()),
    }
}
