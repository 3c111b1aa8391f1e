//! Leases: a run whose client is gone ends in order, and the bench is free. While it waits, its entry leaves the queue.

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

/// What a client keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Leased {
    Run(i64),
    /// A waiting entry of a queue.
    Entry(i64),
}

struct ActiveLease {
    duration: Duration,
    deadline: Instant,
}

/// The leases of active runs and waiting entries.
#[derive(Default)]
pub(super) struct Leases(Mutex<HashMap<Leased, ActiveLease>>);

impl Leases {
    fn lock(&self) -> MutexGuard<'_, HashMap<Leased, ActiveLease>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn deadline(&self, of: Leased) -> Option<Instant> {
        self.lock().get(&of).map(|lease| lease.deadline)
    }

    fn begin(&self, of: Leased, duration: Duration) {
        self.lock().insert(of, ActiveLease { duration, deadline: Instant::now() + duration });
    }

    /// `None` if it has expired or does not exist.
    fn renew(&self, of: Leased) -> Option<Lease> {
        let mut leases = self.lock();
        let lease = leases.get_mut(&of).filter(|lease| lease.deadline > Instant::now())?;
        lease.deadline = Instant::now() + lease.duration;
        Some(Lease { expires_in_s: lease.duration.as_secs_f64() })
    }

    /// Removes the lease of an ended run. Returns whether it has expired.
    pub fn remove_expired(&self, run: i64) -> bool {
        self.lock().remove(&Leased::Run(run)).is_some_and(|lease| lease.deadline <= Instant::now())
    }

    /// Returns when the lease has expired.
    async fn expired(&self, of: Leased) {
        while let Some(deadline) = self.deadline(of).filter(|deadline| *deadline > Instant::now()) {
            sleep_until(deadline).await;
        }
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
        self.inner.leases.begin(Leased::Run(run), duration);
        tokio::spawn(async move {
            tokio::select! {
                () = bench.until_free() => return,
                () = lab.inner.leases.expired(Leased::Run(run)) => {}
            }
            let by = not_renewed(duration);
            tracing::warn!(run.id = run, by, "the run is stopped");
            if let Err(fault) = lab.control(run, Control::Abandon, &by).await {
                tracing::debug!(run.id = run, %fault, "the run ended before its lease");
            }
        });
    }

    /// Removes a waiting entry when its lease expires.
    pub(super) fn watch_entry(&self, entry: i64, duration: Duration) {
        let lab = self.clone();
        self.inner.leases.begin(Leased::Entry(entry), duration);
        tokio::spawn(async move {
            lab.inner.leases.expired(Leased::Entry(entry)).await;
            // An entry that has left the queue is refused.
            match lab.take_from_queue(entry, &not_renewed(duration)).await {
                Ok(_) | Err(LabError::Over(_)) => {}
                Err(fault) => tracing::error!(entry, %fault, "an entry without a client is still in the queue"),
            }
            lab.inner.leases.lock().remove(&Leased::Entry(entry));
        });
    }

    /// Renews the lease of an active run.
    pub async fn renew_lease(&self, run: i64) -> Answer<Lease> {
        let record = self.inner.store.run(run).await?;
        match self.inner.leases.renew(Leased::Run(run)) {
            Some(lease) if !record.state.is_final() => Ok(lease),
            Some(_) => Err(LabError::Over(format!("run {run} has already ended ({})", record.state))),
            None => Err(LabError::Over(format!("run {run} has no active lease: start a run with lease_s"))),
        }
    }

    /// Renews the lease of a waiting entry.
    pub async fn renew_entry_lease(&self, entry: i64) -> Answer<Lease> {
        self.queue_entry(entry).await?;
        self.inner
            .leases
            .renew(Leased::Entry(entry))
            .ok_or_else(|| LabError::Over(format!("queue entry {entry} has no active lease: queue a run with lease_s")))
    }
}

fn not_renewed(duration: Duration) -> String {
    format!("lease not renewed for {} s", duration.as_secs_f64())
}
