//! State of the steps that are planned during the run.

use crate::catalogue::PlannedSteps;
use crate::deferred_plan::DeferredPlan;
use crate::plan::Step;
use jointbench_instrument::Trace;
use std::thread::JoinHandle;

#[derive(Default)]
pub(super) struct DeferredSteps {
    /// Rows that the planning uses.
    pub rows: Trace,
    pub planning: Option<JoinHandle<Result<PlannedSteps, String>>>,
    /// The planned steps; empty if they are omitted. `None` before the planning is done.
    pub steps: Option<Vec<Step>>,
}

impl DeferredSteps {
    pub fn set_columns(&mut self, empty: Trace) {
        self.rows = empty;
    }

    /// Adds a row to the table of the planning, until the planning starts. A step that was repeated after a pause has a number above all others.
    pub fn add_row(&mut self, deferred: Option<&DeferredPlan>, segment: u32, row: &[f64]) {
        if deferred.is_some_and(|deferred| segment >= deferred.from.start)
            && self.planning.is_none()
            && self.steps.is_none()
        {
            self.rows.push_row(row);
        }
    }
}
