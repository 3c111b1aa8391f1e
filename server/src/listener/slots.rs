//! Number of connections. The last ones are reserved for requests that must always be answered.

use super::stage::Progress;
use super::{Demand, Limits};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio_util::sync::CancellationToken;

/// All connections of one listener. Cheap to clone.
#[derive(Debug, Clone)]
pub struct ConnectionSlots {
    limits: Arc<Limits>,
    all: Arc<Mutex<Connections>>,
}

#[derive(Debug, Default)]
struct Connections {
    next: u64,
    places: BTreeMap<u64, Place>,
}

#[derive(Debug)]
struct Place {
    progress: Arc<Progress>,
    close: CancellationToken,
    reserved: bool,
}

impl Connections {
    /// Among the connections that `may` be closed, closes the one that has waited longest for its client.
    fn close_oldest(&mut self, may: impl Fn(&Place) -> bool) -> bool {
        let waiting = self.places.iter().filter(|(_, place)| may(place));
        let oldest = waiting.filter_map(|(id, place)| Some((place.progress.waits_since()?, *id))).min();
        let Some((_, id)) = oldest else { return false };
        if let Some(place) = self.places.remove(&id) {
            place.close.cancel();
        }
        true
    }

    fn ordinary(&self) -> usize {
        self.places.values().filter(|place| !place.reserved).count()
    }
}

impl ConnectionSlots {
    pub fn new(limits: Arc<Limits>) -> Self {
        Self { limits, all: Arc::default() }
    }

    /// A slot for a new connection. If all are in use, it closes the connection that has waited longest for its client.
    /// `None` if all of them are being answered.
    pub fn take(&self) -> Option<ConnectionSlot> {
        let mut all = self.lock();
        if all.places.len() >= self.limits.connections && !all.close_oldest(|_| true) {
            return None;
        }
        let id = all.next;
        all.next += 1;
        let (progress, close) = (Arc::new(Progress::begin()), CancellationToken::new());
        let reserved = all.ordinary() >= self.general();
        all.places.insert(id, Place { progress: progress.clone(), close: close.clone(), reserved });
        Some(ConnectionSlot { id, slots: self.clone(), progress, close })
    }

    /// Closes every connection whose client exceeds a time limit.
    pub fn close_overdue(&self) {
        self.lock().places.retain(|_, place| {
            let overdue = place.progress.is_overdue(&self.limits);
            if overdue {
                place.close.cancel();
            }
            !overdue
        });
    }

    fn general(&self) -> usize {
        self.limits.connections - self.limits.reserved
    }

    fn lock(&self) -> MutexGuard<'_, Connections> {
        self.all.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The slot of one connection, released on drop.
#[derive(Debug)]
pub struct ConnectionSlot {
    id: u64,
    slots: ConnectionSlots,
    pub progress: Arc<Progress>,
    /// Cancelled to close the connection.
    pub close: CancellationToken,
}

impl ConnectionSlot {
    /// Whether a request may be answered on this slot. A reserved slot becomes an ordinary one if an ordinary slot is
    /// free or if another connection on one only waits for its client.
    pub fn admits(&self, demand: Demand) -> bool {
        let mut all = self.slots.lock();
        let id = self.id;
        if demand == Demand::Vital || all.places.get(&id).is_none_or(|place| !place.reserved) {
            return true;
        }
        if all.ordinary() >= self.slots.general() && !all.close_oldest(|place| !place.reserved) {
            return false;
        }
        if let Some(place) = all.places.get_mut(&id) {
            place.reserved = false;
        }
        true
    }
}

impl Drop for ConnectionSlot {
    fn drop(&mut self) {
        self.slots.lock().places.remove(&self.id);
    }
}

#[cfg(test)]
mod tests {
    use super::super::stage::Stage;
    use super::*;

    fn slots() -> ConnectionSlots {
        ConnectionSlots::new(Arc::new(Limits { connections: 4, reserved: 1, ..Limits::default() }))
    }

    #[test]
    fn the_last_seats_are_for_vital_requests_only() {
        let slots = slots();
        let taken: Vec<ConnectionSlot> = (0..4).map(|_| slots.take().unwrap()).collect();
        taken.iter().for_each(|slot| slot.progress.enter(Stage::Answer));
        assert!(taken[..3].iter().all(|slot| slot.admits(Demand::Ordinary)));
        assert!(taken[3].admits(Demand::Vital) && !taken[3].admits(Demand::Ordinary));
        assert!(slots.take().is_none(), "a connection is not closed while it is answered");
    }

    #[test]
    fn a_client_that_only_waits_gives_way_to_one_that_asks() {
        let slots = slots();
        let taken: Vec<ConnectionSlot> = (0..4).map(|_| slots.take().unwrap()).collect();
        taken[0].progress.enter(Stage::Answer);
        assert!(taken[3].admits(Demand::Ordinary));
        assert!(!taken[0].close.is_cancelled() && taken[1].close.is_cancelled() && !taken[2].close.is_cancelled());
        let more = slots.take().unwrap();
        assert!(!taken[2].close.is_cancelled(), "there was a free one");
        assert!(slots.take().is_some() && taken[2].close.is_cancelled(), "the oldest that waits");
        drop((taken, more));
        assert!(slots.lock().places.is_empty());
    }
}
