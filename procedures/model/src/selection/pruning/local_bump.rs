//! Removes a wave that stands for a bump at one angle.
//!
//! Over less than two periods a wave resembles any curve. A weak bump leaves no significant structure over an axis, so that
//! *partial explanation* does not notice it.

use crate::regression::linear_model::Term;
use crate::selection::floating_search::FloatingSearch;
use crate::selection::pruning::partial_explanation::least_whole;
use crate::thresholds::PERIODS_SEEN;
use crate::view::View;

/// A wave with less than two periods in the covered part of a turn, if a free function of the angle would explain more.
pub fn bump<'p>(search: &FloatingSearch<'_, 'p>) -> Option<&'p str> {
    let view = &search.now.problem.view;
    let open = search.added().find(|term| is_open(term, view))?;
    let axis = search.prepared.column_name(open.effect.traits().wave?);
    least_whole(search, search.added().filter(|term| is_open(term, view)), axis)
}

/// Whether the data covers only a part of a turn, and less than two periods of the wave.
fn is_open(term: &Term, view: &View) -> bool {
    let turns = term.effect.traits().wave.map(|angle| view.turns(angle));
    turns.zip(term.shape.first()).is_some_and(|(turns, order)| turns < 1.0 && order * turns < PERIODS_SEEN)
}

#[cfg(test)]
mod tests {
    use super::is_open;
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn a_wave_is_judged_if_less_than_two_periods_are_covered() {
        let tiny = Tiny::over(0.4, Kind::Encoder, &["offset"], |row| row.scatter);
        let is_judged = |order: f64| is_open(&tiny.term("harmonic_n", vec![order]), &tiny.prepared.main.view);
        assert!(is_judged(3.0) && is_judged(4.0) && !is_judged(6.0));
    }
}
