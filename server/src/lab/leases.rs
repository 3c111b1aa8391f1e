//! Leases: a run whose client is gone ends in order, and the bench is free.

use super::{Answer, Lab, LabError};
use crate::bench::BenchHandle;
use crate::view::Lease;
use jointbench_procedure::Control;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::time::{Instant, sleep_until};

/// Shortest and longest lease [s].
const RANGE_S: std::ops::RangeInclusive<f64> = 1.0..=86_400.0;

struct ActiveLease {
    duration: Duration,
    deadline: Instant,
}

/// The leases of the active runs.
#[derive(Default)]
pub(super) struct Leases(Mutex<HashMap<i64, ActiveLease>>);

impl Leases {
    fn lock(&self) -> MutexGuard<'_, HashMap<i64, ActiveLease>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn deadline(&self, run: i64) -> Option<Instant> {
        self.lock().get(&run).map(|lease| lease.deadline)
    }

    /// Whether the lease of a run has expired.
    pub fn has_expired(&self, run: i64) -> bool {
        self.deadline(run).is_some_and(|deadline| deadline <= Instant::now())
    }
}

/// The duration of a lease, if it is possible.
pub(super) fn checked_lease(lease_s: Option<f64>) -> Answer<Option<Duration>> {
    match lease_s {
        Some(s) if !RANGE_S.contains(&s) => {
            Err(LabError::Invalid(format!("lease_s = {s}: choose {} to {} s", RANGE_S.start(), RANGE_S.end())))
        }
        lease_s => Ok(lease_s.map(Duration::from_secs_f64)),
    }
}

impl Lab {
    /// Ends a run when its lease expires.
    pub(super) fn watch_lease(&self, bench: &BenchHandle, run: i64, duration: Duration) {
        let (lab, bench) = (self.clone(), bench.clone());
        self.inner.leases.lock().insert(run, ActiveLease { duration, deadline: Instant::now() + duration });
        tokio::spawn(async move {
            while let Some(deadline) = lab.inner.leases.deadline(run) {
                tokio::select! {
                    () = bench.until_free() => return,
                    () = sleep_until(deadline) => {}
                }
                if lab.inner.leases.has_expired(run) {
                    let by = format!("lease: not renewed for {} s", duration.as_secs_f64());
                    tracing::warn!(run.id = run, by, "the run is stopped");
                    if let Err(fault) = lab.control(run, Control::Stop, &by).await {
                        tracing::debug!(run.id = run, %fault, "the run ended before its lease");
                    }
                    return;
                }
            }
        });
    }

    /// Renews the lease of an active run.
    pub async fn renew_lease(&self, run: i64) -> Answer<Lease> {
        let record = self.inner.store.run(run).await?;
        let mut leases = self.inner.leases.lock();
        match leases.get_mut(&run).filter(|lease| lease.deadline > Instant::now()) {
            Some(lease) if !record.state.is_final() => {
                lease.deadline = Instant::now() + lease.duration;
                Ok(Lease { expires_in_s: lease.duration.as_secs_f64() })
            }
            Some(_) => Err(LabError::Over(format!("run {run} has already ended ({})", record.state))),
            None => Err(LabError::Over(format!("run {run} has no active lease: start a run with lease_s"))),
        }
    }
}
