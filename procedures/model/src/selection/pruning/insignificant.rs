//! Removes an added effect that hardly reduces the validation error.

use crate::regression::cross_validation::validation_losses;
use crate::regression::linear_model::Term;
use crate::selection::floating_search::FloatingSearch;
use rayon::prelude::*;

impl<'p> FloatingSearch<'_, 'p> {
    /// The added effect with the smallest reduction of the validation error, if that is too small because later
    /// effects explain the same. This rule runs after the last addition, because two effects may mask each other
    /// before.
    pub(crate) fn insignificant(&self) -> Option<&'p str> {
        let present = validation_losses(&self.now).iter().sum::<f64>();
        let testable: Vec<&Term<'p>> = self.testable().collect();
        let insignificant = testable.into_par_iter().filter_map(|term| {
            let without = self.model_without(term.id());
            let share = 1.0 - present / validation_losses(&without).iter().sum::<f64>();
            (share < self.options.practical_share).then_some((term.id(), share))
        });
        insignificant.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(id, _)| id)
    }
}

#[cfg(test)]
mod tests {
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn an_effect_that_leaves_the_validation_error_as_it_is_is_insignificant() {
        let removed = |offset: f64| {
            let tiny = Tiny::new(Kind::Friction, &["coulomb"], |row| offset + 5.0 * row.direction + row.scatter);
            tiny.removed(&["direction_offset"], |search| search.insignificant())
        };
        assert_eq!(removed(0.0).as_deref(), Some("direction_offset"));
        assert_eq!(removed(1.0), None);
    }
}
