//! Continuation of an incomplete run: the finished steps, and both runs as one measurement.

use crate::column_names::MOTOR_CURRENT_SETPOINT;
use crate::findings::select_rows;
use crate::recorder::RunId;
use jointbench_instrument::{Meta, RunTable, TableFault, Trace};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Name of the fact that contains [`Continuation`].
const FACT: &str = "continues";
/// Least time between two parts of a measurement.
const PAUSE_S: f64 = 1.0;

/// The continued run, and where this run continues it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Continuation {
    /// The previous run.
    pub run: RunId,
    /// The first step of the whole plan in this run.
    pub from_step: usize,
    /// Steps at the start that only restore the history.
    pub restored: usize,
    /// Number of the first segment of these.
    pub restored_from: u32,
}

impl Continuation {
    /// `None`: the run is no continuation.
    pub fn of(meta: &Meta) -> Option<Self> {
        serde_json::from_value(meta.other.get(FACT)?.clone()).ok()
    }

    pub(crate) fn write_to(self, meta: &mut Meta) {
        let value = serde_json::to_value(self).expect("four numbers are JSON");
        meta.other.insert(FACT.to_owned(), value);
    }

    fn restores(self, segment: u32) -> bool {
        (self.restored_from..).take(self.restored).any(|number| number == segment)
    }
}

/// Finished part of the whole plan of a procedure.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct FinishedSteps {
    /// Steps up to the last finished one.
    pub steps: usize,
    /// Completely measured segments, without those that only restored a history.
    pub segments: BTreeSet<u32>,
    /// The first unused segment number.
    pub next_segment: u32,
}

impl FinishedSteps {
    /// Adds one step of the journal: its number in the run's own plan, its segment, and whether it was finished.
    pub fn add(&mut self, continuation: Option<Continuation>, step: usize, segment: u32, finished: bool) {
        self.next_segment = self.next_segment.max(segment + 1);
        let (from, restored) =
            continuation.map_or((0, 0), |continuation| (continuation.from_step, continuation.restored));
        if finished && step >= restored {
            self.steps = self.steps.max(from + step - restored + 1);
            self.segments.insert(segment);
        }
    }
}

/// Two runs as one measurement: the finished part of the first, and the second without the restored history.
/// `later_s`: time from the start of the first to the start of the second.
pub fn joined(
    first: &RunTable,
    finished: &FinishedSteps,
    second: &RunTable,
    later_s: f64,
) -> Result<RunTable, TableFault> {
    let continuation = Continuation::of(second.meta());
    let measured = rows_of_segments(first, |segment| finished.segments.contains(&segment))?;
    let rest = match rows_of_segments(second, |segment| {
        continuation.is_none_or(|continuation| !continuation.restores(segment))
    }) {
        // The second run is still restoring the history.
        Err(TableFault::Empty) => return Ok(measured),
        rest => rest?,
    };
    let (meta, rest) = rest.into_parts();
    let (_, mut whole) = measured.into_parts();
    let ended_s = whole.column("time_s").and_then(|time_s| time_s.last()).copied().unwrap_or(0.0);
    let begins_s = rest.column("time_s").and_then(|time_s| time_s.first()).copied().unwrap_or(0.0);
    let shift_s = later_s.max(ended_s + PAUSE_S - begins_s);
    // In the column order of the first run, which defines the columns.
    let column = |name: &str| match rest.column(name) {
        Some(values) => Some(values.to_vec()),
        // The remaining steps command no motor current.
        None => (name == MOTOR_CURRENT_SETPOINT).then(|| vec![0.0; rest.len()]),
    };
    let found: Option<Vec<Vec<f64>>> = whole.channels().iter().map(|channel| column(&channel.name)).collect();
    let Some(mut columns) = found else {
        let missing = whole.channels().iter().find(|channel| rest.index_of(&channel.name).is_none());
        return Err(TableFault::Different(missing.map_or_else(String::new, |channel| channel.name.clone())));
    };
    if let Some(time) = whole.index_of("time_s") {
        columns[time].iter_mut().for_each(|time_s| *time_s += shift_s);
    }
    whole.append(Trace::from_columns(whole.channels().to_vec(), columns));
    RunTable::new(meta, whole)
}

/// The rows of some segments.
pub(crate) fn rows_of_segments(table: &RunTable, wanted: impl Fn(u32) -> bool) -> Result<RunTable, TableFault> {
    let segment = table.column("segment").unwrap_or_default();
    let mut start = 0;
    let mut rows = Vec::new();
    for chunk in segment.chunk_by(|a, b| a == b) {
        if wanted(chunk[0] as u32) {
            rows.push(start..start + chunk.len());
        }
        start += chunk.len();
    }
    select_rows(table, &rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_instrument::{Channel, Kind};

    fn table(continuation: Option<Continuation>, rows: &[[f64; 4]]) -> RunTable {
        let mut meta = Meta { kind: Some(Kind::Friction), ..Meta::default() };
        if let Some(continuation) = continuation {
            continuation.write_to(&mut meta);
        }
        let names = ["time_s", "motor_position_rad", "motor_current_a", "segment"];
        let mut trace = Trace::new(names.map(Channel::new).to_vec());
        rows.iter().for_each(|row| trace.push_row(row));
        RunTable::new(meta, trace).unwrap()
    }

    #[test]
    fn two_runs_are_one_measurement_without_what_was_cut_off_and_what_restored() {
        let first = table(None, &[[0.0, 1.0, 0.1, 0.0], [1.0, 1.0, 0.2, 1.0], [2.0, 1.0, 0.3, 2.0]]);
        let mut finished = FinishedSteps::default();
        finished.add(None, 0, 0, true);
        finished.add(None, 1, 1, true);
        finished.add(None, 2, 2, false);
        assert_eq!((finished.steps, finished.next_segment), (2, 3));
        let continuation = Continuation { run: 4, from_step: 2, restored: 1, restored_from: 9 };
        let second = table(Some(continuation), &[[0.0, 1.0, 0.4, 9.0], [1.0, 1.0, 0.5, 2.0], [2.0, 1.0, 0.6, 3.0]]);
        let whole = joined(&first, &finished, &second, 100.0).unwrap();
        assert_eq!(whole.column("motor_current_a").unwrap(), [0.1, 0.2, 0.5, 0.6]);
        assert_eq!(whole.column("time_s").unwrap(), [0.0, 1.0, 101.0, 102.0]);
        // While the second run only restores, the measurement is the finished part of the first.
        let restoring = table(Some(continuation), &[[0.0, 1.0, 0.4, 9.0]]);
        let whole = joined(&first, &finished, &restoring, 100.0).unwrap();
        assert_eq!(whole.column("motor_current_a").unwrap(), [0.1, 0.2]);
        finished.add(Some(continuation), 0, 9, true);
        finished.add(Some(continuation), 1, 2, true);
        assert_eq!((finished.steps, finished.segments.contains(&9)), (3, false));
        // A mock bench is ahead of the wall clock.
        let whole = joined(&first, &finished, &second, 0.1).unwrap();
        assert_eq!(whole.column("time_s").unwrap(), [0.0, 1.0, 2.0, 3.0, 4.0]);
    }
}
