//! Removes an added effect that explains only a part of the structure over its axis.

use crate::effect::Regime;
use crate::linear::basis::dot;
use crate::preprocess::Problem;
use crate::regression::linear_model::Term;
use crate::residual_analysis::maps::Maps;
use crate::selection::floating_search::FloatingSearch;
use crate::selection::pruning::Trial;
use crate::thresholds::{MOST_EXPLAINED, PERIODS_SEEN, WHOLE_CURVE};

/// An added effect that only resembles the missing one: structure remains over its axis, and a free function of that
/// axis would explain much more. Example: a wave over the angle fitted to a bump at one angle.
pub fn partially_explained<'p>(trial: &Trial<'_, '_, 'p>) -> Option<&'p str> {
    let search = trial.search;
    // Hysteresis is a function of no axis, even if a repeated motion makes it look like one.
    let of_axes = search.added().filter(|term| term.effect.traits().regime != Regime::Hysteresis);
    least_whole(search, of_axes, trial.axis()?)
}

/// The effect with the smallest share of what a free function of the axis explains, if that share is too small.
pub(super) fn least_whole<'s, 'p: 's>(
    search: &'s FloatingSearch<'_, 'p>,
    terms: impl Iterator<Item = &'s Term<'p>>,
    axis: &str,
) -> Option<&'p str> {
    let (now, prepared, options) = (&search.now, search.prepared, search.options);
    let (full, coefficients) = (now.linear().sse, now.linear().coefficients);
    let share = |term: &Term<'p>| {
        let at = now.terms.iter().position(|t| t.id() == term.id())?;
        let mut contribution = vec![0.0; now.problem.rows()];
        for (column, coefficient) in term.columns.iter().zip(&coefficients[at]) {
            contribution.iter_mut().zip(column).for_each(|(s, c)| *s += coefficient * c);
        }
        let residual = search.now.without(term.id()).linear().residual;
        let explained = 1.0 - full / dot(&residual, &residual);
        let any =
            Maps::new(prepared, residual, options).any_function(&Maps::new(prepared, contribution, options), axis)?;
        Some((term.id(), explained / any / share_of_whole(term, now.problem)))
    };
    let least = terms.filter_map(share).min_by(|a, b| a.1.total_cmp(&b.1))?;
    (least.1 < 1.0).then_some(least.0)
}

/// Least share of a free function of its axis that an effect has to explain.
fn share_of_whole(term: &Term, problem: &Problem) -> f64 {
    let wave = term.effect.traits().wave.zip(term.shape.first());
    match wave.is_some_and(|(angle, order)| order * problem.view.turns(angle) < PERIODS_SEEN) {
        true => WHOLE_CURVE,
        false => MOST_EXPLAINED,
    }
}

#[cfg(test)]
mod tests {
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn a_wave_explains_a_bump_over_the_angle_only_in_part() {
        let removed = |over_angle: fn(f64) -> f64| {
            let tiny = Tiny::new(Kind::Friction, &["coulomb"], |row| {
                5.0 * row.direction + over_angle(row.angle) + 0.05 * row.scatter
            });
            tiny.removed(&["gravity"], |search| super::least_whole(search, search.added(), "link_position_rad"))
        };
        assert_eq!(removed(|angle| f64::from(u8::from((1.0..2.0).contains(&angle)))).as_deref(), Some("gravity"));
        assert_eq!(removed(f64::cos), None);
    }
}
