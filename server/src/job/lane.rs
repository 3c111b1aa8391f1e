//! How many computations are on at once, and how many wait.

use crate::lab::LabError;
use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// At once: a fit takes every core by itself, and memory by the size of its run.
const AT_ONCE: usize = 2;
/// Who comes when so many wait is sent away, and may come again.
const WAITING: usize = 16;

#[derive(Debug)]
pub struct Lane {
    places: Arc<Semaphore>,
    slots: Arc<Semaphore>,
}

/// The right to compute; given back when dropped.
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
    /// Waits for its turn. [`LabError::Busy`] where too many wait already, or where the daemon ends.
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

    /// Nobody's turn comes any more.
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
    async fn whoever_comes_too_late_is_sent_away() {
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
