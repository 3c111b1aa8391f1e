//! An added effect that brings too little on held-out data.

use crate::regression::cross_validation::held_out;
use crate::regression::linear_model::Term;
use crate::selection::floating_search::FloatingSearch;
use rayon::prelude::*;

impl<'p> FloatingSearch<'_, 'p> {
    /// The added effect that brings least on what was held out, where that is not worth a name: whatever came in since
    /// explains the rest of it. Asked when nothing more can be added, because on the way two effects may mask each other.
    pub(crate) fn idle(&self) -> Option<&'p str> {
        let present = held_out(&self.now).iter().sum::<f64>();
        let on_trial: Vec<&Term<'p>> = self.on_trial().collect();
        let idle = on_trial.into_par_iter().filter_map(|term| {
            let without = self.model_without(term.id());
            let share = 1.0 - present / held_out(&without).iter().sum::<f64>();
            (share < self.options.practical_share).then_some((term.id(), share))
        });
        idle.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(id, _)| id)
    }
}
