//! Cache of the latest results of a problem, by name: a report needs the same solution several times.

use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};

/// Number of cached results.
const KEPT: usize = 6;

type Entry = (String, Arc<dyn Any + Send + Sync>);

/// Copies share the cache.
#[derive(Clone, Default)]
pub struct Memo(Arc<Mutex<Vec<Entry>>>);

impl std::fmt::Debug for Memo {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        to.write_str("Memo")
    }
}

impl Memo {
    /// The cached result of this name, computed if it is missing.
    pub fn of<T: Any + Send + Sync>(&self, name: String, make: impl FnOnce() -> T) -> Arc<T> {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = lock().iter().find(|(known, _)| *known == name).map(|(_, value)| value.clone());
        if let Some(Ok(known)) = known.map(Arc::downcast) {
            return known;
        }
        let made = Arc::new(make());
        let mut all = lock();
        if all.len() >= KEPT {
            all.remove(0);
        }
        all.push((name, made.clone()));
        made
    }
}
