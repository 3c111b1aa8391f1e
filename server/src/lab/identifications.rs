//! Results that a procedure identifies from a stored run.

use super::calibrations::applies;
use super::computation::{Turn, parsed, with_retries};
use super::{Answer, Lab, LabError};
use crate::bench::BenchHandle;
use crate::job::Job;
use crate::limits::{self, LimitsFile, Measured};
use crate::store::{RunRecord, Subject};
use crate::view::{self, Earlier, FollowUp, Identification, LimitCheck, LiveMessage, Quantity, Shown, word};
use jointbench_procedure::RunState;
use jointbench_procedure::parameter::Values;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Limit of a small plot.
const EARLIER: u32 = 12;
/// Limit of results that one request computes: the client shows the known ones in the meantime.
const AT_ONCE: usize = 8;
/// Limit at a start: the daemon does not evaluate a whole store.
const LEFT: u32 = 200;
/// Cache keys of parts of an identification.
const QUANTITIES: &str = "quantities";
const FOLLOW_UP: &str = "follow_up";
/// Kind of an event.
const WARNING: &str = "warning";

impl Lab {
    /// Results of comparable earlier runs, newest first. Runs without a result are omitted.
    pub async fn earlier(&self, id: i64) -> Answer<Vec<Earlier>> {
        let record = self.inner.store.run(id).await?;
        let applied = self.inner.store.calibration(&record.bench, &record.procedure).await?;
        let _turn = self.inner.turns.of(Turn::Earlier).await;
        let mut earlier = Vec::new();
        for (run, created_at) in self.inner.store.earlier(id, applied, EARLIER).await? {
            match self.quantities(run).await {
                Ok(quantities) => earlier.push(Earlier { run, created_at, holds: applied == Some(run), quantities }),
                Err(LabError::NotFound(_) | LabError::Invalid(_)) => {}
                Err(fault) => return Err(fault),
            }
        }
        Ok(earlier)
    }

    /// The quantities of a complete run.
    pub(super) async fn quantities(&self, run: i64) -> Answer<Vec<Quantity>> {
        self.kept_of(run, QUANTITIES, |found| found.result.quantities).await
    }

    /// The quantities of several complete runs, without those that have no result. Computes a few that are not known yet,
    /// and counts the others for a later request.
    pub(super) async fn quantities_of_runs<R>(
        &self,
        runs: Vec<R>,
        id: impl Fn(&R) -> i64,
    ) -> Answer<(Vec<(R, Vec<Quantity>)>, u64)> {
        let (mut found, mut pending, mut computed) = (Vec::new(), 0, 0);
        for run in runs {
            let known = self.quantities_known(id(&run)).await?;
            if known.is_none() && computed == AT_ONCE {
                pending += 1;
                continue;
            }
            computed += usize::from(known.is_none());
            let quantities = match known {
                Some(quantities) => quantities,
                None => match self.quantities(id(&run)).await {
                    Ok(quantities) => quantities,
                    Err(LabError::NotFound(_) | LabError::Invalid(_)) => continue,
                    Err(fault) => return Err(fault),
                },
            };
            found.push((run, quantities));
        }
        Ok((found, pending))
    }

    /// The quantities if they are already in the cache.
    async fn quantities_known(&self, run: i64) -> Answer<Option<Vec<Quantity>>> {
        self.cached(Subject::Run(run), QUANTITIES).await
    }

    /// The next run that a complete run recommends, with parameters.
    pub(super) async fn follow_up(&self, run: i64) -> Answer<Option<FollowUp>> {
        self.kept_of(run, FOLLOW_UP, |found| found.follow_up).await
    }

    /// A cached part of the identification of a complete run.
    async fn kept_of<T: Serialize + DeserializeOwned>(
        &self,
        run: i64,
        what: &str,
        part: impl FnOnce(Identification) -> T,
    ) -> Answer<T> {
        if let Some(kept) = self.cached(Subject::Run(run), what).await? {
            return Ok(kept);
        }
        // The result of an active run changes: it is not cached.
        let is_over = self.inner.store.run(run).await?.state.is_final();
        let part = part(self.identification(run).await?);
        if is_over {
            self.cache(Subject::Run(run), what, &part).await?;
        }
        Ok(part)
    }

    /// Identifies the result from the samples each time, so that it always corresponds to the current code. Without its
    /// samples a run has the result from the moment when they were dropped.
    pub async fn identification(&self, id: i64) -> Answer<Identification> {
        let record = self.inner.store.run(id).await?;
        if jointbench_procedure::procedure(&record.procedure).is_none() {
            return Err(no_result(id, &record.procedure));
        }
        if let Some(result) = self.inner.store.result_of_dropped(id).await? {
            return parsed(&result);
        }
        let cut = record.state.is_final() && record.state != RunState::Completed;
        let step = if cut { self.last_step(id).await? } else { None };
        let found: Identification = self.compute(Job::Identify { run: id, step }).await?;
        let verdict = found.result.verdict;
        let limits = found.limits.as_ref().map(|check| word(check.outcome));
        let values = values_by_name(&found.result.quantities);
        let is_kept = record.verdict.as_ref() == Some(&word(verdict))
            && record.limits == limits
            && self.inner.store.quantities_kept(id).await?.as_ref() == Some(&values);
        if record.state.is_final() && !is_kept {
            match self.inner.store.keep_verdict(id, &word(verdict), limits.as_deref(), &values).await {
                Ok(()) => self.hub().publish(LiveMessage::Verdict { run: id, verdict }),
                // The result is valid although its verdict is not stored.
                Err(fault) => {
                    tracing::warn!(run.id = id, %fault, "what came of the run is not kept for the list of runs");
                }
            }
        }
        Ok(found)
    }

    /// The JUnit report of an ended run: one test case for the run, and one for each of its limits.
    pub async fn junit(&self, id: i64) -> Answer<String> {
        let run = self.run(id).await?;
        if !run.summary.state.is_final() {
            return Err(LabError::Conflict(format!("run {id} is not over: wait for its end")));
        }
        let found = match run.summary.state {
            view::RunState::Completed => Some(self.identification(id).await),
            _ => None,
        };
        let fault = found.as_ref().and_then(|found| found.as_ref().err()).map(ToString::to_string);
        let found = found.and_then(Result::ok);
        let of_run = found.as_ref().map(Ok).or(fault.as_deref().map(Err));
        let mut cases = vec![limits::run_case(&run, of_run)];
        match &found {
            Some(found) => cases.extend(found.limits.iter().flat_map(limits::cases_of)),
            None => {
                let kept = limits::of_run(&run).map_err(LabError::Internal)?;
                cases.extend(kept.iter().map(|limit| limits::skipped_case(&limit.text)));
            }
        }
        let warnings = found.as_ref().map_or(&[][..], |found| &found.result.warnings);
        Ok(limits::junit(&run.summary.bench, &cases, warnings))
    }

    pub(super) async fn identify_here(&self, id: i64, step: Option<String>) -> Answer<Identification> {
        let record = self.inner.store.run(id).await?;
        let none = || no_result(id, &record.procedure);
        let procedure = jointbench_procedure::procedure(&record.procedure).ok_or_else(none)?;
        let values = Values::parse(procedure.schema(), &record.parameters)
            .map_err(|fault| LabError::Invalid(format!("run {id} was made by another version: {fault}")))?;
        let table = self.measurement(id).await?;
        let runs = self.together(id).await?;
        let mut found = tokio::task::spawn_blocking(move || procedure.identify(&values, &table))
            .await
            .map_err(|fault| LabError::Internal(format!("the identification of run {id} failed: {fault}")))?
            .ok_or_else(none)?
            .of_run(id, record.state, procedure.can_resume().is_ok(), step.as_deref());
        if let [before @ .., last] = runs.as_slice()
            && !before.is_empty()
        {
            let before: Vec<String> = before.iter().map(i64::to_string).collect();
            found = found.introduced(&format!("Runs {} and {last} together:", before.join(", ")));
        }
        let follow_up = procedure.follow_up(&found);
        let result = Shown::new(found, self.warnings(&runs).await?);
        Ok(Identification {
            run: id,
            limits: limit_check(&record, &result)?,
            applies: applies(&record.procedure),
            procedure: record.procedure.clone(),
            software: concat!("jointbench ", env!("CARGO_PKG_VERSION")).to_owned(),
            follow_up,
            result,
        })
    }

    /// The warnings of all runs of a measurement, without repetition.
    async fn warnings(&self, runs: &[i64]) -> Answer<Vec<String>> {
        let mut warnings = Vec::new();
        for run in runs {
            let journal = self.inner.store.events(*run, 0).await?;
            let texts =
                journal.iter().filter(|event| event.kind == WARNING).filter_map(|event| event.data["text"].as_str());
            warnings.extend(texts.map(str::to_owned));
        }
        warnings.dedup();
        Ok(warnings)
    }

    /// Stores the verdict after the end of a run, because the list of runs does not compute results.
    pub(super) fn judge_when_ended(&self, bench: &BenchHandle, run: i64) {
        let (lab, bench) = (self.clone(), bench.clone());
        tokio::spawn(async move {
            bench.until_free().await;
            lab.judge(run).await;
        });
    }

    /// The same for older runs without a verdict, for example after a crash; one after another.
    pub(super) fn judge_unjudged_runs(&self) {
        let lab = self.clone();
        tokio::spawn(async move {
            match lab.inner.store.unjudged(LEFT).await {
                Ok(runs) => {
                    for run in runs {
                        lab.judge(run).await;
                    }
                }
                Err(fault) => tracing::warn!(%fault, "runs without a computed result cannot be listed"),
            }
        });
    }

    /// A run without a result is not a fault. Its notifications wait for this.
    async fn judge(&self, run: i64) {
        if let Err(fault) = with_retries(|| self.identification(run)).await {
            tracing::debug!(run.id = run, %fault, "no result of the run");
        }
        if let Err(fault) = self.inner.store.release_notifications(run).await {
            tracing::warn!(run.id = run, %fault, "the notifications of the run wait longer");
        }
    }
}

/// The finite values of quantities, ordered by name; of two with one name the first.
fn values_by_name(quantities: &[Quantity]) -> Vec<(String, f64)> {
    let finite = quantities.iter().filter(|one| one.value.is_finite());
    let mut values: Vec<(String, f64)> = finite.map(|one| (one.name.clone(), one.value)).collect();
    values.sort_by(|a, b| a.0.cmp(&b.0));
    values.dedup_by(|later, first| later.0 == first.0);
    values
}

/// The result of a run compared with its limits.
fn limit_check(record: &RunRecord, result: &Shown) -> Answer<Option<LimitCheck>> {
    let kept = LimitsFile::kept(&record.provenance).map_err(LabError::Internal)?;
    let Some(file) = kept else { return Ok(None) };
    let check = file.check(&Measured::new(record.unit.as_ref(), &record.procedure), &record.parameters, result);
    check.map(Some).map_err(|fault| LabError::Internal(format!("the limits of run {}: {fault}", record.id)))
}

fn no_result(run: i64, procedure: &str) -> LabError {
    LabError::NotFound(format!("run {run} ({procedure}) has no result of a procedure: fit a model to it instead"))
}
