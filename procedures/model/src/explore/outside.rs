//! What no effect of the library explains, and effects that only live on it.

use super::Withdrawal;
use crate::Options;
use crate::effect::Stage;
use crate::linear::dot;
use crate::maps::Maps;
use crate::pieces::{legs, pieces};
use crate::prepare::{Prepared, Problem, stretches};
use crate::report::NoiseFloor;
use crate::select::{Ground, Search, Wander, alone, within};
use crate::terms::Term;

/// A map must take this share off held-out squared error to be called structure. Over null runs the best map reaches
/// 2 %, and what is left of well-explained runs 11 %.
pub const STRUCTURE_SHARE: f64 = 0.15;

/// An effect that takes less than this share of what any function of its own axis would take is not what is missing.
const WHOLE_EXPLANATION: f64 = 0.7;

/// A wave that was not there this often is a curve over the angle with three numbers, which follows many others.
const PERIODS: f64 = 2.0;
const WHOLE_CURVE: f64 = 0.98;

/// Columns of which less than this share is left beside an axis are a function of it.
const FUNCTION: f64 = 0.1;

/// The axis over which structure remains.
pub fn structured(maps: &Maps) -> Option<&str> {
    maps.removable().filter(|(_, share)| *share > STRUCTURE_SHARE).map(|(axis, _)| axis)
}

/// What shows over an axis is what whole stretches of motion differ by, a zero that wanders or lies elsewhere after every
/// reversal: little of it comes again for sure in another repeat, and no part of any axis stands out of that scatter.
pub fn is_scatter(
    search: &Search,
    maps: &Maps,
    residual: &[f64],
    floor: &NoiseFloor,
    prepared: &Prepared,
    options: &Options,
) -> bool {
    let surely = floor.repeatable_ci95.is_none_or(|[least, _]| least > 0.0);
    let comes_again = floor.repeatable_share.is_none_or(|share| share > STRUCTURE_SHARE) && surely;
    if structured(maps).is_none() || comes_again {
        return false;
    }
    let is_known = floor.ci95.is_some();
    match Wander::of(&search.now, options) {
        Some(wander) => only_wanders(&wander, residual, prepared, options) || is_known && !maps.stand_out(),
        None => is_known && !(maps.stand_out_beside_time() && stands_out_within_legs(residual, prepared, options)),
    }
}

/// Nothing shows over any axis but a zero that wanders over time: a little everywhere, and no figure of the model leaps.
fn only_wanders(wander: &Wander, residual: &[f64], prepared: &Prepared, options: &Options) -> bool {
    let beside = Maps::new(prepared, wander.taken_off(residual), options);
    structured(&beside).is_none() && !beside.stand_out() && !wander.is_of_events() && !wander.leaps(options)
}

/// Where legs are too few to tell what they scatter by, some part of an axis stands out within them, each with a zero of its own.
fn stands_out_within_legs(residual: &[f64], prepared: &Prepared, options: &Options) -> bool {
    let problem = &prepared.main;
    let leg = legs(problem);
    if pieces(problem, 1).0 == leg {
        return true;
    }
    Maps::new(prepared, within(residual, &stretches(&leg)), options).stand_out_beside_time()
}

/// An added effect that is only the nearest relative of what is missing: structure remains over its own axis, and any
/// function of that axis would take away much more than it does. A wave over the angle is not the answer to a bump at
/// one angle.
fn half_explained<'p>(search: &Search<'_, 'p>, axis: &str, prepared: &Prepared, options: &Options) -> Option<&'p str> {
    // What depends on the past is a function of no axis, even where a repeated motion makes it look like one.
    let of_axes = search.added().filter(|term| term.effect.stage() != Stage::Memory);
    least_whole(search, of_axes, axis, prepared, options)
}

/// A wave over a part of a turn of which less than two periods were seen, where any function of its angle would take more, or
/// structure remains over the angle beside it: a bump at this place. A weak one leaves nothing that could be called structure.
pub fn bump<'p>(search: &Search<'_, 'p>, maps: &Maps, prepared: &Prepared, options: &Options) -> Option<&'p str> {
    let view = &search.now.problem.view;
    let is_open = |term: &&Term<'p>| {
        let turns = term.effect.wave().map(|angle| view.turns(angle));
        turns.zip(term.shape.first()).is_some_and(|(turns, order)| turns < 1.0 && order * turns < PERIODS)
    };
    let open = search.added().find(is_open)?;
    let axis = prepared.column_name(open.effect.wave()?);
    let remains = (structured(maps) == Some(axis)).then_some(open.id());
    remains.or_else(|| least_whole(search, search.added().filter(is_open), axis, prepared, options))
}

/// The effect that takes least of what any function of the axis would take, where that is too little.
fn least_whole<'s, 'p: 's>(
    search: &'s Search<'_, 'p>,
    terms: impl Iterator<Item = &'s Term<'p>>,
    axis: &str,
    prepared: &Prepared,
    options: &Options,
) -> Option<&'p str> {
    let now = &search.now;
    let (full, factors) = (now.linear().sse, now.linear().factors);
    let share = |term: &Term<'p>| {
        let at = now.terms.iter().position(|t| t.id() == term.id())?;
        let mut contribution = vec![0.0; now.problem.rows()];
        for (column, factor) in term.columns.iter().zip(&factors[at]) {
            contribution.iter_mut().zip(column).for_each(|(s, c)| *s += factor * c);
        }
        let residual = search.now.without(term.id()).linear().residual;
        let own = 1.0 - full / dot(&residual, &residual);
        let any =
            Maps::new(prepared, residual, options).any_function(&Maps::new(prepared, contribution, options), axis)?;
        Some((term.id(), own / any / least_share(term, now.problem)))
    };
    let least = terms.filter_map(share).min_by(|a, b| a.1.total_cmp(&b.1))?;
    (least.1 < 1.0).then_some(least.0)
}

/// Share of what any function of its own axis would take that an effect has to take.
fn least_share(term: &Term, problem: &Problem) -> f64 {
    let wave = term.effect.wave().zip(term.shape.first());
    match wave.is_some_and(|(angle, order)| order * problem.view.turns(angle) < PERIODS) {
        true => WHOLE_CURVE,
        false => WHOLE_EXPLANATION,
    }
}

/// An added effect that is taken back where structure remains over an axis.
pub fn taken_back<'p>(
    search: &Search<'_, 'p>,
    maps: &Maps,
    axis: &str,
    prepared: &Prepared,
    options: &Options,
) -> Option<(&'p str, Withdrawal)> {
    let half = half_explained(search, axis, prepared, options).map(|id| (id, Withdrawal::HalfExplains));
    half.or_else(|| Some((borrowing(search, maps, axis, options)?, Withdrawal::Borrows)))
}

/// An added effect that lives on what shows over an axis that is not its own: beside any function of that axis there is
/// nothing that it explains. A wave whose mean changes from step to step follows any curve over the speed a little.
fn borrowing<'p>(search: &Search<'_, 'p>, maps: &Maps, axis: &str, options: &Options) -> Option<&'p str> {
    let functions = maps.functions(axis);
    let is_borrowed = |term: &&Term<'p>| {
        let without = search.now.without(term.id());
        let mut basis = without.tangent();
        functions.iter().for_each(|f| {
            basis.push(f);
        });
        let left = basis.rest(&without.response());
        let ground = Ground::new(basis, left, search.now.problem);
        let own = ground.own(&term.columns);
        own.visible > FUNCTION && (own.share < options.practical_share || alone(term, &ground, options) > options.alpha)
    };
    search.added().filter(|term| term.effect.stage() != Stage::Memory).find(is_borrowed).map(Term::id)
}
