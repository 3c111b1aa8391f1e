//! What was worked out of a problem last, by name: a report asks for the same solution again and again.

use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};

/// So many are kept.
const KEPT: usize = 6;

type Entry = (String, Arc<dyn Any + Send + Sync>);

/// A copy shares what is known.
#[derive(Clone, Default)]
pub struct Memo(Arc<Mutex<Vec<Entry>>>);

impl std::fmt::Debug for Memo {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        to.write_str("Memo")
    }
}

impl Memo {
    /// What has this name, made where it is not known.
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
