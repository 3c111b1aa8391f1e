//! Queue entries of the [`keeper`](super::keeper).

use super::status::NewFault;
use super::wire::Entry;
use jointbench_procedure::{RunId, Safe};
use std::sync::Arc;
use tokio::sync::oneshot;

pub(super) enum Item {
    Entry(Arc<Entry>),
    /// The worker ended: the keeper stores the end of its run.
    Interrupted {
        run: RunId,
        safe: Safe,
        reason: &'static str,
    },
    Fault(NewFault),
    /// Answered when all earlier items are stored.
    Flush(oneshot::Sender<()>),
}
