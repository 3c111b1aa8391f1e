//! Benches and requests to them.

use super::blocking::blocking;
use super::calibrations::BRAKE_MODEL;
use super::{Answer, Lab, LabError};
use crate::bench::{BenchHandle, bench_view};
use crate::job::Job;
use crate::store::{RunFilter, RunRecord};
use crate::view::{self, Bench, BenchState, ProcedureRefusal, RefusalReason, safety_entry};
use jointbench_instrument::zero::TORQUE_ZERO;
use jointbench_procedure::catalogue::{brake_model, compared_brake};
use jointbench_procedure::parameter::{Parameter, ParameterKind, Values};
use jointbench_procedure::{
    BenchFacts, BrakeModel, ComparedBrake, Plan, PlanFault, Preview, Procedure, RunState, catalogue, procedure,
};
use serde_json::{Map, Value};
use std::time::Duration;
use tokio::time::timeout;

/// Number of latest runs in a search for a run of the bench, and of entries of the safety record.
const RECENT: u32 = 100;
/// Waiting time at start until the store has accepted the first records.
const STORES: Duration = Duration::from_secs(5);

impl Lab {
    pub fn benches(&self) -> Vec<Bench> {
        self.inner.benches.iter().map(|bench| bench_view(bench.description(), &bench.status())).collect()
    }

    pub fn bench(&self, name: &str) -> Answer<Bench> {
        let bench = self.handle(name)?;
        Ok(bench_view(bench.description(), &bench.status()))
    }

    pub fn handle(&self, name: &str) -> Answer<&BenchHandle> {
        self.inner.benches.iter().find(|bench| bench.name() == name).ok_or_else(|| {
            let names: Vec<&str> = self.inner.benches.iter().map(BenchHandle::name).collect();
            LabError::NotFound(format!("bench {name} does not exist; this daemon has {}", names.join(", ")))
        })
    }

    /// Ends a run on this bench immediately, or secures the idle bench. No run starts until a person resets the bench.
    pub async fn emergency_stop(&self, name: &str, by: &str) -> Answer<Bench> {
        tracing::warn!(bench = name, by, "software stop");
        self.handle(name)?.stop(by).await;
        self.bench(name)
    }

    /// Reconnects the instruments that are not ready.
    pub async fn retry(&self, name: &str) -> Answer<Bench> {
        let bench = self.handle(name)?;
        drop(bench.claim()?);
        bench.reopen().await?;
        self.bench(name)
    }

    pub async fn safety(&self, name: &str) -> Answer<Vec<view::SafetyEntry>> {
        self.handle(name)?;
        let entries = self.inner.store.safety(name, RECENT).await?;
        Ok(entries.into_iter().map(safety_entry).collect())
    }

    pub async fn acknowledge(&self, name: &str, reason: &str, by: &str) -> Answer<Bench> {
        let bench = self.handle(name)?;
        if reason.trim().is_empty() {
            return Err(LabError::Invalid("enter a reason: findings and action taken at the bench".into()));
        }
        let Some(block) = bench.status().blocked else {
            return Err(LabError::Conflict(format!("bench {name} is not blocked, so no reset is needed")));
        };
        if !block.stored {
            return Err(LabError::Busy(format!(
                "bench {name} is blocked, but the block is not yet stored: check the disk, then reset again"
            )));
        }
        let lifted = self.inner.store.acknowledge_bench(name, &block.since, reason.trim(), by).await?;
        if !(lifted && bench.lift(&block.since)) {
            return Err(LabError::Conflict(format!(
                "bench {name} was blocked again in the meantime: inspect the bench, then reset it"
            )));
        }
        tracing::warn!(bench = name, reason, by, "block lifted by a person");
        self.bench(name)
    }

    /// The catalogue; with a bench, it includes the procedures' problems on that bench.
    pub async fn procedures(&self, bench: Option<&str>) -> Answer<Vec<view::Procedure>> {
        let facts = bench.map(|name| self.handle(name)).transpose()?.map(BenchHandle::facts);
        let mut procedures = Vec::new();
        for one in catalogue() {
            let given = match bench {
                Some(bench) => self.applied_choices(bench, one.id()).await?.map(|(_, given)| given),
                None => None,
            }
            .unwrap_or_default();
            let refused = facts.as_ref().and_then(|facts| refusal(*one, &given, facts));
            procedures.push(procedure_view(*one, &given, refused));
        }
        Ok(procedures)
    }

    /// Dry run. Nothing moves.
    pub async fn preview(&self, bench: &str, id: &str, parameters: &Map<String, Value>) -> Answer<view::Preview> {
        let (bench, plan) = self.plan(bench, id, parameters).await?;
        Ok(previewed(bench, &plan))
    }

    pub(super) async fn plan(
        &self,
        bench: &str,
        id: &str,
        parameters: &Map<String, Value>,
    ) -> Answer<(&BenchHandle, Plan)> {
        let bench = self.handle(bench)?;
        let procedure = procedure(id).ok_or_else(|| {
            let known: Vec<&str> = catalogue().iter().map(|procedure| procedure.id()).collect();
            LabError::NotFound(format!("procedure {id} does not exist; available: {}", known.join(", ")))
        })?;
        let mut facts = bench.facts();
        let (friction, given) = self.applied_choices(bench.name(), id).await?.unzip();
        let given = given.unwrap_or_default();
        let mut choices = given.clone();
        choices.extend(parameters.clone());
        let values = Values::parse(procedure.schema(), &choices).map_err(PlanFault::from)?;
        let mut source = None;
        if let Some(run) = procedure.brake_model(&values) {
            (source, facts.brake_model) = self.brake_model(bench.name(), i64::from(run)).await?.unzip();
        }
        let compared = procedure.compared_brake(&values).map(i64::from);
        if let Some(run) = compared {
            facts.compared_brake = Some(self.compared_brake(run).await?);
        }
        let mut plan = procedure.plan(&choices, &facts)?;
        let mut add = |fact: &str, value: Value| plan.meta.other.insert(fact.to_owned(), value);
        if let Some(run) = compared {
            add("compared_brake_of_run", run.into());
        }
        if let Some(run) = source {
            add("brake_model_of_run", run.into());
        }
        let used = |(name, value): (&String, &Value)| choices[name].as_f64() == value.as_f64();
        if let Some(run) = friction.filter(|_| given.iter().any(used)) {
            add("friction_of_run", run.into());
        }
        if facts.has_torque_sensor
            && let Some((run, zero_nm)) = self.applied_zero(bench.name(), procedure).await?
        {
            add(TORQUE_ZERO, zero_nm.into());
            add("torque_sensor_zero_of_run", run.into());
        }
        Ok((bench, plan))
    }

    /// The brake model that a run of `brake_hysteresis` identified on this bench. Run 0 selects the applied run or else
    /// the last completed one. `None` if no such run exists.
    async fn brake_model(&self, bench: &str, run: i64) -> Answer<Option<(i64, BrakeModel)>> {
        let applied = self.inner.store.calibration(bench, BRAKE_MODEL).await?;
        let record = match (run, applied) {
            (0, Some(run)) => Some(self.inner.store.run(run).await?),
            (0, None) => self.newest_brake_model(bench).await?,
            (id, _) => Some(self.inner.store.run(id).await?),
        };
        let Some(record) = record else { return Ok(None) };
        let id = record.id;
        if record.bench != bench || record.procedure != BRAKE_MODEL {
            return Err(LabError::Invalid(format!(
                "run {id} is not a {BRAKE_MODEL} run of bench {bench}: enter such a run, or 0 for the applied run (without one, the latest)"
            )));
        }
        let model: Option<BrakeModel> = self.compute(Job::BrakeModel { run: id }).await?;
        let missing = || {
            LabError::Invalid(format!(
                "run {id} ended before its model was identified: repeat \
                                                    {BRAKE_MODEL}"
            ))
        };
        model.map(|model| Some((id, model))).ok_or_else(missing)
    }

    /// The last completed run of `brake_hysteresis` on this bench.
    async fn newest_brake_model(&self, bench: &str) -> Answer<Option<RunRecord>> {
        let search = Some(format!("procedure:{BRAKE_MODEL} state:completed"));
        let (_, runs) = self.inner.store.runs(&RunFilter { limit: RECENT, search, ..RunFilter::default() }).await?;
        Ok(runs.into_iter().find(|run| run.bench == bench))
    }

    /// Whether the next runs of its bench, or the run that continues it, need the samples of this run.
    pub(super) async fn is_needed(&self, id: i64) -> Answer<bool> {
        let store = &self.inner.store;
        let RunRecord { bench, procedure, state, .. } = store.run(id).await?;
        if store.calibration(&bench, &procedure).await? == Some(id) {
            return Ok(true);
        }
        // A complete run is never continued.
        if state != RunState::Completed
            && let Some(later) = store.continued_by(id).await?
            && store.archive_of(later).await?.iter().all(|table| table.dropped_at.is_none())
        {
            return Ok(true);
        }
        Ok(procedure == BRAKE_MODEL && self.newest_brake_model(&bench).await?.is_some_and(|newest| newest.id == id))
    }

    pub(super) async fn brake_model_here(&self, run: i64) -> Answer<Option<BrakeModel>> {
        let table = self.measurement(run).await?;
        blocking(move || Ok(brake_model(&table))).await
    }

    /// The brake that a run of any bench has measured.
    async fn compared_brake(&self, run: i64) -> Answer<ComparedBrake> {
        let record = self.inner.store.run(run).await?;
        if record.procedure != BRAKE_MODEL {
            return Err(LabError::Invalid(format!(
                "run {run} is not a {BRAKE_MODEL} run: enter such a run for compare_run, or 0 for no comparison"
            )));
        }
        let brake: Option<ComparedBrake> = self.compute(Job::ComparedBrake { run }).await?;
        brake.ok_or_else(|| {
            LabError::Invalid(format!("run {run} ended before its model was identified: repeat {BRAKE_MODEL}"))
        })
    }

    pub(super) async fn compared_brake_here(&self, run: i64) -> Answer<Option<ComparedBrake>> {
        let table = self.measurement(run).await?;
        blocking(move || Ok(compared_brake(&table))).await
    }

    pub(super) async fn wait_until_secured(&self) {
        for bench in &self.inner.benches {
            let mut watch = bench.watch();
            // An error means that the thread has ended; its status contains the reason.
            drop(watch.wait_for(|status| status.settled).await);
            // By now the ends of interrupted runs are stored, or the bench reports why not.
            drop(timeout(STORES, watch.wait_for(|status| status.runs.is_empty())).await);
        }
    }
}

/// Preview of a plan on its bench, with the conditions that prevent a start now.
pub(super) fn previewed(bench: &BenchHandle, plan: &Plan) -> view::Preview {
    let Preview { duration_s, steps, extremes, setpoints, mut checks } = plan.preview(&bench.facts());
    let wait_s = bench.description().pace().map(|pace| duration_s / pace);
    checks.extend(readiness(bench));
    view::Preview { duration_s, wait_s, steps, extremes, setpoints, checks }
}

fn readiness(bench: &BenchHandle) -> Vec<view::Check> {
    let status = bench.status();
    let faults = status.faults();
    let busy = matches!(status.state, BenchState::Running | BenchState::Paused | BenchState::Securing);
    vec![
        view::Check {
            name: "instruments".into(),
            ok: faults.is_none(),
            detail: faults.clone().unwrap_or_else(|| "all instruments respond".into()),
            cure: faults.map(|_| "check power, cables and ports, then reconnect the instruments".into()),
        },
        view::Check {
            name: "acknowledged".into(),
            ok: status.blocked.is_none(),
            detail: status.blocked.as_ref().map_or_else(|| "none active".into(), |blocked| blocked.reason.clone()),
            cure: status.blocked.map(|_| "inspect the bench, then reset it with a reason".into()),
        },
        view::Check {
            name: "free".into(),
            ok: !busy,
            detail: status.run.map_or_else(|| "bench idle".into(), |run| format!("run {run} is in progress")),
            cure: busy.then(|| "wait for it to finish, or stop it".into()),
        },
    ]
}

/// Why a procedure cannot run with its defaults or the applied values, without checks that need earlier runs.
fn refusal(procedure: &dyn Procedure, given: &Map<String, Value>, facts: &BenchFacts) -> Option<ProcedureRefusal> {
    let defaults = Values::parse(procedure.schema(), given).ok()?;
    if procedure.brake_model(&defaults).is_some() {
        let text = || format!("bench {} has no brake", facts.name);
        return (!facts.has_brake).then(|| ProcedureRefusal { reason: RefusalReason::MissingInstrument, text: text() });
    }
    let (reason, text) = match procedure.plan(given, facts) {
        Ok(plan) => {
            let check = plan.preview(facts).checks.into_iter().find(|check| !check.ok)?;
            (RefusalReason::Limit, check.refusal())
        }
        Err(fault) => {
            let reason = match &fault {
                PlanFault::MissingInstrument { .. } => RefusalReason::MissingInstrument,
                PlanFault::Parameter(_) => RefusalReason::Parameter,
                PlanFault::Contradiction { .. } => RefusalReason::Contradiction,
            };
            (reason, fault.to_string())
        }
    };
    Some(ProcedureRefusal { reason, text })
}

fn procedure_view(
    procedure: &dyn Procedure,
    given: &Map<String, Value>,
    refused: Option<ProcedureRefusal>,
) -> view::Procedure {
    view::Procedure {
        id: procedure.id().to_owned(),
        title: procedure.title().to_owned(),
        summary: procedure.summary().to_owned(),
        kind: procedure.kind().to_string(),
        parameters: procedure.schema().iter().map(|one| parameter_view(one, given)).collect(),
        refused,
    }
}

fn parameter_view(parameter: &Parameter, given: &Map<String, Value>) -> view::ProcedureParameter {
    view::ProcedureParameter {
        name: parameter.name.to_owned(),
        title: parameter.title.to_owned(),
        unit: parameter.unit.to_owned(),
        default: given.get(parameter.name).and_then(Value::as_f64).unwrap_or(parameter.default),
        min: parameter.min,
        max: parameter.max,
        type_: match parameter.kind {
            ParameterKind::Number => view::ParameterType::Number,
            ParameterKind::Integer => view::ParameterType::Integer,
            ParameterKind::Fraction => view::ParameterType::Fraction,
            ParameterKind::Curve => view::ParameterType::Curve,
        },
    }
}
