//! Removes a wave that stands for a bump at one angle.
//!
//! Over less than two periods a wave resembles any curve. A weak bump leaves no significant structure over an axis, so that
//! *partial explanation* does not notice it.

use crate::regression::linear_model::Term;
use crate::selection::floating_search::FloatingSearch;
use crate::selection::pruning::partial_explanation::least_whole;
use crate::thresholds::PERIODS_SEEN;

/// A wave with less than two periods in the covered part of a turn, if a free function of the angle would explain more.
pub fn bump<'p>(search: &FloatingSearch<'_, 'p>) -> Option<&'p str> {
    let view = &search.now.problem.view;
    let is_open = |term: &&Term<'p>| {
        let turns = term.effect.traits().wave.map(|angle| view.turns(angle));
        turns.zip(term.shape.first()).is_some_and(|(turns, order)| turns < 1.0 && order * turns < PERIODS_SEEN)
    };
    let open = search.added().find(is_open)?;
    let axis = search.prepared.column_name(open.effect.traits().wave?);
    least_whole(search, search.added().filter(is_open), axis)
}

#[cfg(test)]
mod tests {
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn a_wave_over_part_of_a_turn_does_not_stand_for_a_bump() {
        let removed = |over_angle: fn(f64) -> f64| {
            let tiny = Tiny::over(0.4, Kind::Friction, &["coulomb"], |row| {
                5.0 * row.direction + over_angle(row.angle) + 0.02 * row.scatter
            });
            tiny.removed(&["cogging"], super::bump)
        };
        assert_eq!(removed(|angle| f64::from(u8::from((0.6..1.6).contains(&angle)))).as_deref(), Some("cogging"));
        assert_eq!(removed(|angle| (4.0 * angle).cos()), None);
    }
}
