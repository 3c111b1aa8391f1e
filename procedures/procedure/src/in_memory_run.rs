//! Performs one run in memory: plan, run, identify. For campaigns and tests; the server stores its runs.

use crate::bench_facts::BenchFacts;
use crate::catalogue::Procedure;
use crate::identification::Identification;
use crate::parameter::Values;
use crate::plan::PlanFault;
use crate::recorder::{Commit, Live, Recorder, RecorderFault};
use crate::state::RunState;
use crate::{RunEnd, run};
use jointbench_instrument::{Bench, RunTable, TableFault, Trace};
use serde_json::{Map, Value};
use std::sync::mpsc::channel;

/// Result of a run.
#[derive(Debug)]
pub struct InMemoryRun {
    /// Samples of the run with its facts.
    pub table: RunTable,
    /// `None` if the procedure only records samples.
    pub identification: Option<Identification>,
    /// Duration of the run on the bench clock.
    pub duration_s: f64,
}

/// Why a run in memory has no result.
#[derive(Debug, thiserror::Error)]
pub enum InMemoryRunFault {
    /// The procedure cannot be planned for this bench.
    #[error(transparent)]
    Plan(#[from] PlanFault),
    /// The dry run found a condition that is not met.
    #[error("{procedure} did not start: {why}")]
    NotAllowed {
        /// Id of the procedure.
        procedure: &'static str,
        /// The condition, with advice.
        why: String,
    },
    /// The run did not complete, or was not secured.
    #[error("{procedure} ended {}: {}", .end.state, .end.reason.as_deref().unwrap_or("no reason given"))]
    Ended {
        /// Id of the procedure.
        procedure: &'static str,
        /// State, safe state and reason.
        end: Box<RunEnd>,
    },
    /// The recorded samples are no run table.
    #[error("table of the run: {0}")]
    Table(#[from] TableFault),
}

/// Plans a procedure, runs it to its end and identifies the result.
pub fn run_in_memory(
    bench: &mut Bench,
    procedure: &dyn Procedure,
    parameters: &Map<String, Value>,
) -> Result<InMemoryRun, InMemoryRunFault> {
    let facts = BenchFacts::of(bench);
    run_in_memory_with_facts(bench, &facts, procedure, parameters)
}

/// The same with additional facts about the bench.
pub fn run_in_memory_with_facts(
    bench: &mut Bench,
    facts: &BenchFacts,
    procedure: &dyn Procedure,
    parameters: &Map<String, Value>,
) -> Result<InMemoryRun, InMemoryRunFault> {
    let plan = procedure.plan(parameters, facts)?;
    let preview = plan.preview(facts);
    if let Some(broken) = preview.checks.iter().find(|check| !check.ok) {
        return Err(InMemoryRunFault::NotAllowed { procedure: procedure.id(), why: broken.refusal() });
    }
    let mut recorder = RowRecorder::default();
    // Held until the end, because a dropped sender stops a run.
    let (_held, controls) = channel();
    let end = run(bench, &plan, 0, &controls, &mut recorder);
    if end.state != RunState::Completed {
        return Err(InMemoryRunFault::Ended { procedure: procedure.id(), end: Box::new(end) });
    }
    let table = RunTable::new(plan.meta, recorder.rows.unwrap_or_default())?;
    let values = Values::parse(procedure.schema(), parameters).map_err(PlanFault::from)?;
    let identification = procedure.identify(&values, &table);
    Ok(InMemoryRun { table, identification, duration_s: end.duration_s })
}

#[derive(Default)]
struct RowRecorder {
    rows: Option<Trace>,
}

impl Recorder for RowRecorder {
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        Ok(None)
    }

    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault> {
        if !commit.rows.channels().is_empty() {
            match &mut self.rows {
                Some(rows) => rows.append(commit.rows),
                None => self.rows = Some(commit.rows),
            }
        }
        Ok(())
    }

    fn live(&mut self, _: Live<'_>) {}
}
