//! The periodic check of a running daemon.

use super::super::Store;
use super::super::health::StoreHealth;
use std::sync::PoisonError;
use std::time::Duration;

/// Delay of the first check after a start.
const FIRST: Duration = Duration::from_secs(60);
const DAY: Duration = Duration::from_secs(24 * 3600);
/// Pause between two runs.
const PACE: Duration = Duration::from_secs(1);

impl Store {
    pub fn health(&self) -> StoreHealth {
        self.health.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Checks all runs once a day, one run per second, until the store is closed.
    pub async fn check_daily(self) {
        let closed = self.readers.close_event();
        let checks = async {
            tokio::time::sleep(FIRST).await;
            loop {
                self.check_now(PACE).await;
                tokio::time::sleep(DAY).await;
            }
        };
        tokio::select! {
            () = closed => {}
            () = checks => {}
        }
    }

    async fn check_now(&self, pace: Duration) {
        let report = match self.check(pace).await {
            Ok(report) => report,
            Err(fault) => {
                tracing::error!(%fault, "the store could not be checked");
                return;
            }
        };
        for finding in &report.damaged {
            tracing::error!(run = finding.run, table = finding.table, what = finding.what, "damaged");
        }
        let health = StoreHealth { checked_at: Some(report.checked_at), damaged: report.damaged, lost: report.lost };
        *self.health.write().unwrap_or_else(PoisonError::into_inner) = health;
    }
}
