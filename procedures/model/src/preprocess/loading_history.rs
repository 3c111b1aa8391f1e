//! Repeats of a brake at one current are the same where it came there on the same way.

use crate::hysteresis_operators;
use crate::preprocess::Problem;
use crate::signal::Signal;

/// Dry contacts that stand for any hysteresis, evenly up to half of the range: what reaches farther never slips.
const CONTACTS: usize = 8;
/// Share of the largest current by which what they remember may differ.
const SAME: f64 = 0.03;

/// Parts the replicate pairs that do not remember the same: a current in loops of different size has torques of its own in each.
pub fn part(problem: &mut Problem) {
    let view = &problem.view;
    let current = view.get(Signal::Current);
    let samples = view.samples.find(Signal::Current).unwrap_or_default();
    let ends = samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), i| (l.min(*i), h.max(*i)));
    let allowed = SAME * ends.0.abs().max(ends.1.abs());
    for contact in 1..=CONTACTS {
        let reach = (ends.1 - ends.0) / 2.0 * contact as f64 / CONTACTS as f64;
        let bent = view.average(hysteresis_operators::stop(samples, reach, &view.starts));
        // Its other end follows the current and never goes farther than that.
        let end: Vec<f64> = current.iter().zip(&bent).map(|(current, bent)| current - reach * bent).collect();
        let differ = |a: usize, b: usize| (end[a] - end[b]).abs() > allowed + (current[a] - current[b]).abs();
        problem.different_history.extend(problem.replicate_pairs.iter().filter(|(a, b)| differ(*a, *b)));
    }
}
