//! Repeats of a brake at one current are replicates only with the same loading history.

use crate::hysteresis_operators;
use crate::preprocess::Problem;
use crate::signal::Signal;
use crate::stats::summary::range;
use crate::thresholds::SAME_LEVEL;

/// Stop operators that represent any hysteresis, evenly spaced up to half of the range; larger ones never slip.
const CONTACTS: usize = 8;

/// Marks replicate pairs with different hysteresis states: a current in loops of different size has a different
/// torque in each.
pub fn part(problem: &mut Problem) {
    let view = &problem.view;
    let current = view.get(Signal::Current);
    let samples = view.samples.find(Signal::Current).unwrap_or_default();
    let ends = range(samples);
    let allowed = SAME_LEVEL * ends.0.abs().max(ends.1.abs());
    for contact in 1..=CONTACTS {
        let reach = (ends.1 - ends.0) / 2.0 * contact as f64 / CONTACTS as f64;
        let bent = view.average(hysteresis_operators::stop(samples, reach, &view.starts));
        // The other end of a stop operator follows the current and cannot move farther than the current does.
        let end: Vec<f64> = current.iter().zip(&bent).map(|(current, bent)| current - reach * bent).collect();
        let differ = |a: usize, b: usize| (end[a] - end[b]).abs() > allowed + (current[a] - current[b]).abs();
        problem.different_history.extend(problem.replicate_pairs.iter().filter(|(a, b)| differ(*a, *b)));
    }
}
