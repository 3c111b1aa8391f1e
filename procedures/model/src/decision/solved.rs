//! Models of a problem that were solved last: a report asks for the same one again and again.

use crate::decision::solution::Solution;
use std::sync::{Arc, Mutex, PoisonError};

/// So many are kept.
const KEPT: usize = 6;

/// What a model is made of, in words, with its solution.
type Entry = (String, Arc<Solution>);

/// A copy shares what is known.
#[derive(Clone, Default)]
pub struct Solved(Arc<Mutex<Vec<Entry>>>);

impl std::fmt::Debug for Solved {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        to.write_str("Solved")
    }
}

impl Solved {
    /// The solution of a model of this name, made where it is not known.
    pub fn of(&self, name: String, make: impl FnOnce() -> Solution) -> Arc<Solution> {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, known)) = lock().iter().find(|(known, _)| *known == name) {
            return known.clone();
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
