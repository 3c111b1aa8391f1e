//! Limits the number of simultaneous and waiting computations.

use crate::error::LabError;
use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Simultaneous computations: a fit uses every core, and memory in proportion to its run.
const AT_ONCE: usize = 2;
/// Further requests are refused and can be repeated later.
const WAITING: usize = 16;

#[derive(Debug)]
pub struct Lane {
    places: Arc<Semaphore>,
    slots: Arc<Semaphore>,
}

/// Permission to compute, released on drop.
#[derive(Debug)]
pub struct Turn {
    _place: OwnedSemaphorePermit,
    _slot: OwnedSemaphorePermit,
}

impl Default for Lane {
    fn default() -> Self {
        Self { places: Arc::new(Semaphore::new(AT_ONCE + WAITING)), slots: Arc::new(Semaphore::new(AT_ONCE)) }
    }
}

impl Lane {
    /// Waits for a free place. [`LabError::Busy`] if too many are waiting, or if the daemon ends.
    pub async fn enter(&self) -> Result<Turn, LabError> {
        let busy = || {
            LabError::Busy(format!(
                "{AT_ONCE} computations are running and {WAITING} are queued: retry in a few \
                                    seconds"
            ))
        };
        let place = self.places.clone().try_acquire_owned().map_err(|_| busy())?;
        let slot = self.slots.clone().acquire_owned().await.map_err(|_| ending())?;
        Ok(Turn { _place: place, _slot: slot })
    }

    /// Refuses all waiting and later computations.
    pub fn close(&self) {
        self.slots.close();
    }
}

pub(super) fn ending() -> LabError {
    LabError::Busy("the daemon is shutting down: retry after its restart".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_request_beyond_the_queue_is_refused() {
        let lane = Arc::new(Lane::default());
        let on = [lane.enter().await.unwrap(), lane.enter().await.unwrap()];
        let waiting: Vec<_> = (0..WAITING)
            .map(|_| {
                let lane = lane.clone();
                tokio::spawn(async move { lane.enter().await.map(drop) })
            })
            .collect();
        tokio::task::yield_now().await;
        assert!(matches!(lane.enter().await, Err(LabError::Busy(_))));
        drop(on);
        for one in waiting {
            one.await.unwrap().unwrap();
        }
        lane.enter().await.unwrap();
        lane.close();
        assert!(matches!(lane.enter().await, Err(LabError::Busy(_))));
    }
}
