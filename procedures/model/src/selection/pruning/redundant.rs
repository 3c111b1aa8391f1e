//! Removes an added effect without which the model is as good.

use crate::regression::linear_model::Term;
use crate::selection::floating_search::FloatingSearch;
use rayon::prelude::*;

impl<'p> FloatingSearch<'_, 'p> {
    /// The added effect without which the model is as good. The effect that was added last is exempt, because it has
    /// just passed the test.
    pub(crate) fn redundant(&self) -> Option<&'p str> {
        let full = self.now.linear().sse;
        let ids = self.testable().map(Term::id).filter(|id| self.last != Some(id));
        let ids: Vec<&'p str> = ids.collect();
        let share = |id: &'p str| {
            let without = self.now.without(id);
            let share = 1.0 - full / without.linear().sse;
            // An effect is not redundant if the others become physically impossible without it.
            (share < self.options.practical_share && self.infeasible(&without).is_none()).then_some((id, share))
        };
        ids.into_par_iter().filter_map(share).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(id, _)| id)
    }
}

#[cfg(test)]
mod tests {
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn an_effect_without_which_the_model_is_as_good_is_redundant_unless_it_was_added_last() {
        let tiny = |viscous: f64| {
            Tiny::new(Kind::Friction, &["coulomb"], move |row| {
                5.0 * row.direction + viscous * row.velocity + row.scatter
            })
        };
        assert_eq!(tiny(0.0).removed(&["viscous"], |search| search.redundant()).as_deref(), Some("viscous"));
        assert_eq!(tiny(1.0).removed(&["viscous"], |search| search.redundant()), None);
        let last = |search: &super::FloatingSearch<'_, '_>| search.last.is_some();
        assert_eq!(tiny(0.0).removed(&[], |search| last(search).then_some("an effect")), None);
    }
}
