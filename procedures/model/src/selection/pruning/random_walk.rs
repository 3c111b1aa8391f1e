//! Removes an added effect that is explained by a random-walk offset.

use crate::regression::candidates::Regressor;
use crate::regression::linear_model::Term;
use crate::residual_analysis::random_walk_offset::Ar1Offset;
use crate::selection::acceptance::between_leg_variance::shows_within_blocks;
use crate::selection::floating_search::FloatingSearch;

impl<'p> FloatingSearch<'_, 'p> {
    /// An added effect that shows only between stretches of motion, and there explains no more than a drifting offset
    /// does.
    pub(crate) fn follows_random_walk(&self) -> Option<&'p str> {
        self.added().next()?;
        let random_walk = Ar1Offset::of(&self.now, self.options)?;
        let mut open: Vec<&str> = self.library.candidates.iter().map(Regressor::id).collect();
        open.dedup();
        let explained = |term: &&Term<'p>| Some((random_walk.gain(term, open.len(), self.options)?, term.id()));
        let within = |term: &&Term<'p>| shows_within_blocks(term, &self.now, self.options);
        let explained = self.added().filter(|term| !within(term)).filter_map(|term| explained(&term));
        explained.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, id)| id)
    }
}

#[cfg(test)]
mod tests {
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn a_temperature_explains_nothing_of_a_wandering_offset() {
        let removed = |of_temperature: f64, of_walk: f64| {
            let tiny = Tiny::warmed(
                Kind::Encoder,
                &["offset"],
                |row| 25.0 + 0.1 * row.leg as f64,
                |row| of_temperature * row.leg as f64 + of_walk * row.walk + 0.1 * row.scatter,
            );
            tiny.removed(&["temperature_drift"], |search| search.follows_random_walk())
        };
        assert_eq!(removed(0.0, 1.0).as_deref(), Some("temperature_drift"));
        assert_eq!(removed(1.0, 0.0), None);
    }
}
