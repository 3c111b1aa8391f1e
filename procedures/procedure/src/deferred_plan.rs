//! Steps that are planned during the run, from a result of the run itself.

use crate::resume::{FinishedSteps, rows_of_segments};
use jointbench_instrument::{RunTable, TableFault};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::Arc;

/// Steps that depend on a result of the run itself ([`crate::Procedure::plan_deferred`]). Until then they are planned for an
/// expected joint, so that duration and travel are known before any motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DeferredPlan {
    /// Segments that the planning uses.
    pub from: Range<u32>,
    /// Segments of the dependent steps.
    pub to: Range<u32>,
    /// The earlier measurement of the same plan, and its finished part.
    pub earlier: Option<Arc<(RunTable, FinishedSteps)>>,
}

impl DeferredPlan {
    /// Rows of an earlier measurement that the planning uses: the source segments, and repeated steps, whose numbers
    /// are above all others.
    pub fn source_rows(&self, table: &RunTable) -> Result<RunTable, TableFault> {
        rows_of_segments(table, |segment| self.from.contains(&segment) || segment >= self.to.end)
    }
}
