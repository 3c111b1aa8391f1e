//! Computations on whole runs: in a separate process for a daemon, in this process for a command.

use super::{Answer, Lab, LabError};
use crate::job::Job;
use crate::store::Subject;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::Duration;
use tokio::sync::OwnedMutexGuard;

impl Lab {
    /// The result of a job, of the type that [`Lab::answer`] returns.
    pub(super) async fn compute<T: DeserializeOwned>(&self, job: Job) -> Answer<T> {
        parsed(&self.compute_json(job).await?)
    }

    /// The same as bytes.
    pub(super) async fn compute_json(&self, job: Job) -> Answer<Vec<u8>> {
        match &self.inner.jobs {
            Some(jobs) => jobs.run(&job).await,
            None => self.answer(job).await,
        }
    }

    /// Computes a job in this process. It only reads the store.
    pub(crate) async fn answer(&self, job: Job) -> Answer<Vec<u8>> {
        match job {
            Job::Fit { runs, effects, excluded, settings, offer } => {
                self.fit_here(&runs, &effects, &excluded, &settings, offer).await
            }
            Job::Diagnose { model, offer } => json(&self.diagnose_here(model, offer).await?),
            Job::NextRun { diagnosis, offer } => json(&self.next_run_here(diagnosis, offer).await?),
            Job::Residuals { model } => self.residuals_here(model).await,
            Job::ResidualMap { models, region } => json(&self.residual_map_here(&models, region).await?),
            Job::CompareModels { first, second, run } => json(&self.compare_here(first, second, run).await?),
            Job::Worth { model } => json(&self.worth_here(model).await?),
            Job::WithEffect { model, effect } => json(&self.with_effect_here(model, &effect).await?),
            Job::Evaluate { model, run } => json(&self.evaluate_here(model, run).await?),
            Job::EvaluateFile { file, run } => json(&self.evaluate_file_here(file, run).await?),
            Job::TryEffect { trial } => json(&self.try_effect_here(&trial).await?),
            Job::Identify { run, step } => json(&self.identify_here(run, step).await?),
            Job::OverlayModel { run } => json(&self.model_overlay_here(run).await?),
            Job::BrakeModel { run } => json(&self.brake_model_here(run).await?),
            Job::ComparedBrake { run } => json(&self.compared_brake_here(run).await?),
            Job::Recall { run, lesson } => self.recall_here(run, &lesson).await,
            Job::Statistics { run, channels, from_s, to_s } => {
                json(&self.statistics_here(run, channels.as_deref(), from_s, to_s).await?)
            }
            Job::CompareRuns { runs, how } => json(&self.compare_runs_here(&runs, &how).await?),
            Job::Derived { run, formulas, window, most } => {
                json(&self.derived_here(run, &formulas, window, most).await?)
            }
            Job::Spectrum { run, formula, window } => json(&self.spectrum_here(run, &formula, window).await?),
            Job::Import { request, rows, uploaded } => json(&self.read_here(request, &rows, uploaded).await?),
            Job::Preview { request, uploaded } => json(&self.preview_here(request, uploaded).await?),
            Job::Archive(request) => json(&self.archive_here(&request).await?),
            Job::CheckArchived(file) => json(&self.check_archived_here(&file).await?),
            Job::Export(request) => {
                let out = Gathered::default();
                self.export_into(request, out.clone()).await?;
                Ok(out.take())
            }
        }
    }
}

/// A writer whose bytes remain available after it is dropped.
#[derive(Clone, Default)]
pub(super) struct Gathered(Arc<Mutex<Vec<u8>>>);

impl Gathered {
    /// The bytes since the last call.
    pub fn take(&self) -> Vec<u8> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl std::io::Write for Gathered {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Lab {
    /// A result that an earlier request has computed. One that this version cannot read is computed again.
    pub(super) async fn cached<T: DeserializeOwned>(&self, subject: Subject, what: &str) -> Answer<Option<T>> {
        let kept = self.inner.store.cached_result(subject, what).await?;
        Ok(kept.and_then(|kept| serde_json::from_slice(&kept).ok()))
    }

    pub(super) async fn cache(&self, subject: Subject, what: &str, result: &impl Serialize) -> Answer<()> {
        Ok(self.inner.store.cache_result(subject, what, &json(result)?).await?)
    }
}

pub(super) fn json(value: &impl Serialize) -> Answer<Vec<u8>> {
    serde_json::to_vec(value).map_err(|fault| LabError::Internal(fault.to_string()))
}

pub(super) fn parsed<T: DeserializeOwned>(json: &[u8]) -> Answer<T> {
    serde_json::from_slice(json).map_err(|fault| LabError::Internal(format!("an answer cannot be read: {fault}")))
}

/// Number and interval of the daemon's own retries after `Busy`: ten minutes, as long as a computation may take.
const TRIES: u32 = 120;
const AGAIN: Duration = Duration::from_secs(5);

/// For the daemon's own work, for which no client waits: retries until a process is free.
pub(super) async fn with_retries<T, F: Future<Output = Answer<T>>>(mut work: impl FnMut() -> F) -> Answer<T> {
    for _ in 1..TRIES {
        match work().await {
            Err(LabError::Busy(_)) => tokio::time::sleep(AGAIN).await,
            done => return done,
        }
    }
    work().await
}

/// Results that only one task computes at a time; other tasks wait and find it in the cache.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Turn {
    /// The version of a run without a parent.
    First(i64),
    Diagnosis(i64),
    Residuals(i64),
    Worth(i64),
    /// Results of the runs of a bench.
    Earlier,
}

/// One lock for each subject.
#[derive(Debug, Default)]
pub(super) struct Turns {
    on: Mutex<HashMap<Turn, Weak<tokio::sync::Mutex<()>>>>,
}

impl Turns {
    /// Waits for the lock of this subject.
    pub async fn of(&self, subject: Turn) -> OwnedMutexGuard<()> {
        let turn = {
            let mut on = self.on.lock().unwrap_or_else(PoisonError::into_inner);
            on.retain(|_, turn| turn.strong_count() > 0);
            let there = on.get(&subject).and_then(Weak::upgrade);
            there.unwrap_or_else(|| {
                let turn = Arc::default();
                on.insert(subject, Arc::downgrade(&turn));
                turn
            })
        };
        turn.lock_owned().await
    }
}
