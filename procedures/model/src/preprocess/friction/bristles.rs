//! Presliding: the direction of friction as a state that changes over a displacement, not instantly.
//!
//! Elements that slip at ±1 (stop operators) and elements with exponential approach (Dahl). Their reaches range from
//! the encoder step to a quarter of the range of motion, or of a turn. The torque at reversals determines their
//! weights.

use crate::hysteresis_operators::{dahl, stop};
use crate::linear::basis::{Basis, dot};
use crate::linear::non_negative::non_negative;
use crate::report::fit::Bristles;
use crate::stats::summary::{quantile, range};
use crate::view::Start;
use std::f64::consts::TAU;
use std::ops::Range;

/// Number of reaches.
const REACHES: usize = 9;
/// Longest reach, as a share of the range of motion. For rotating contacts the range is at most a turn [rad], because
/// the same contacts return after a turn.
const LONGEST: f64 = 0.25;
const TURN: f64 = TAU;
/// Shortest reach, in encoder steps, as a share of the range, and as a share of the longest reach.
const STEPS: f64 = 3.0;
const LEAST_OF_RANGE: f64 = 1e-5;
const LEAST_OF_LONGEST: f64 = 1e-4;
/// Smaller differences are numerical.
const LEAST_STEP_RAD: f64 = 1e-7;
/// Least return motion of a reversal, in encoder steps and as a share of the whole range.
const TURN_STEPS: f64 = 6.0;
const TURN_SHARE: f64 = 1e-3;

/// The step of the encoder: the smallest difference between neighbouring samples. A joint that is fast most of the time
/// passes single counts only at its reversals.
pub fn encoder_step(position: &[f64]) -> f64 {
    steps(position).reduce(f64::min).unwrap_or(LEAST_STEP_RAD)
}

/// The motion in a sample where the joint is slowest. Presliding over less is not distinguished from a direction that
/// changes between two samples.
pub fn slowest_step(position: &[f64]) -> f64 {
    quantile(steps(position), 0.01).max(LEAST_STEP_RAD)
}

fn steps(position: &[f64]) -> impl Iterator<Item = f64> {
    position.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|step| *step > LEAST_STEP_RAD)
}

/// Smallest motion that differs from encoder noise.
fn depth(position: &[f64], step: f64) -> f64 {
    let (low, high) = range(position);
    (TURN_STEPS * step).max(TURN_SHARE * (high - low))
}

fn recordings(samples: usize, starts: &[usize]) -> impl Iterator<Item = Range<usize>> {
    let ends = starts.iter().skip(1).copied().chain([samples]);
    starts.iter().zip(ends).map(|(start, end)| *start..end)
}

/// Samples at which the position reverses by more than the encoder noise, for each recording.
pub fn turns(position: &[f64], starts: &[usize], step: f64) -> Vec<usize> {
    let depth = depth(position, step);
    let turns_of = |range: Range<usize>| {
        let start = range.start;
        zigzag(&position[range], depth).into_iter().map(move |turn| start + turn)
    };
    recordings(position.len(), starts).flat_map(turns_of).collect()
}

/// The sign of the motion, if all recordings move in the same direction. Between recordings a joint may return unseen.
/// A run that pauses at each point may move only between its recordings: then the positions of all of them count.
pub fn only_direction(position: &[f64], starts: &[usize], step: f64) -> Option<f64> {
    let depth = depth(position, step);
    let over = |range: Range<usize>| position[range.end - 1] - position[range.start];
    let mut moves: Vec<f64> = recordings(position.len(), starts).map(over).filter(|d| d.abs() > depth).collect();
    if moves.is_empty() {
        let turns = zigzag(position, depth);
        moves.extend(turns.is_empty().then(|| over(0..position.len())));
    }
    let first = moves.first()?.signum();
    moves.iter().all(|d| d.signum() == first).then_some(first)
}

fn zigzag(x: &[f64], depth: f64) -> Vec<usize> {
    let mut turns = Vec::new();
    let (mut way, mut low, mut high) = (0.0, 0, 0);
    for i in 0..x.len() {
        if way >= 0.0 && x[i] > x[high] {
            high = i;
        }
        if way <= 0.0 && x[i] < x[low] {
            low = i;
        }
        if way >= 0.0 && x[high] - x[i] > depth {
            if way > 0.0 {
                turns.push(high);
            }
            (way, low) = (-1.0, i);
        } else if way <= 0.0 && x[i] - x[low] > depth {
            if way < 0.0 {
                turns.push(low);
            }
            (way, high) = (1.0, i);
        }
    }
    turns
}

/// Reaches that the reversals of this motion can identify. Empty without reversals.
pub fn reaches(position: &[f64], turns: &[usize], step: f64, slides: bool) -> Vec<f64> {
    if turns.is_empty() {
        return Vec::new();
    }
    let (low, high) = range(position);
    let range = if slides { high - low } else { TURN.min(high - low) };
    let shortest = (STEPS * step).max(LEAST_OF_RANGE * range);
    let longest = (LONGEST * range).max(8.0 * shortest);
    crate::effects::log_grid(shortest.max(LEAST_OF_LONGEST * longest), longest, REACHES)
}

/// States of all elements: stop operators, then Dahl elements without the shortest reach.
pub fn states(position: &[f64], starts: &[usize], reaches: &[f64]) -> Vec<Vec<f64>> {
    let starts: Vec<Start> = starts.iter().copied().map(Start::from).collect();
    let stops = reaches.iter().map(|reach| stop(position, *reach, &starts));
    let yielding = reaches.iter().skip(1).map(|reach| dahl(position, *reach, &starts));
    stops.chain(yielding).collect()
}

/// Weights of the elements that explain most of a torque, given the `free` columns; `elements` are their states at
/// the rows.
pub fn weights(elements: &[Vec<f64>], free: &[Vec<f64>], torque: &[f64]) -> Vec<f64> {
    let basis = Basis::of(free);
    let orthogonalized: Vec<Vec<f64>> = elements.iter().map(|state| basis.rest(state)).collect();
    let gram: Vec<f64> = orthogonalized.iter().flat_map(|a| orthogonalized.iter().map(|b| dot(a, b))).collect();
    let left = basis.rest(torque);
    let side: Vec<f64> = orthogonalized.iter().map(|a| dot(a, &left)).collect();
    let mut weights = non_negative(&gram, &side);
    let all: f64 = weights.iter().sum();
    match all > 0.0 {
        true => weights.iter_mut().for_each(|w| *w /= all),
        false => weights.iter_mut().take(1).for_each(|w| *w = 1.0),
    }
    weights
}

/// The direction of friction as the weighted sum of the element states.
pub fn direction_state(states: &[Vec<f64>], bristles: &Bristles) -> Vec<f64> {
    let mut direction_state = vec![0.0; states.first().map_or(0, Vec::len)];
    for (state, weight) in states.iter().zip(&bristles.weights).filter(|(_, weight)| **weight > 0.0) {
        direction_state.iter_mut().zip(state).for_each(|(sum, z)| *sum += weight * z);
    }
    direction_state
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_position_turns_where_it_goes_back_by_more_than_noise() {
        let x: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 0.02).sin() + 1e-4 * f64::from(i % 2)).collect();
        let found = turns(&x, &[0], 1e-4);
        assert_eq!(found.len(), 6, "{found:?}");
        assert!(found.iter().all(|i| x[*i].abs() > 0.999));
    }

    #[test]
    fn a_joint_that_is_fast_most_of_the_time_shows_the_count_of_its_encoder() {
        let count = TAU / 65_536.0;
        let angle = |i: i32| (f64::from(i) * 1e-3).sin() * 50.0;
        let x: Vec<f64> = (0..20_000).map(|i| (angle(i) / count).round() * count).collect();
        let found = encoder_step(&x);
        assert!((0.9 * count..8.1 * count).contains(&found), "{} counts", found / count);
        assert!(slowest_step(&x) > 5.0 * found);
    }

    #[test]
    fn the_elements_of_a_contact_are_found() {
        let x: Vec<f64> = (0..4000).map(|i| (f64::from(i) * 0.01).sin() * (1.0 + f64::from(i) * 1e-4)).collect();
        let reaches = reaches(&x, &turns(&x, &[0], 1e-5), 1e-5, false);
        let states = states(&x, &[0], &reaches);
        let torque: Vec<f64> = (0..x.len()).map(|i| 0.3 * states[5][i] + 0.1 * states[14][i] + 0.02 * x[i]).collect();
        let found = weights(&states, &[x], &torque);
        assert!((found[5] - 0.75).abs() < 0.02 && (found[14] - 0.25).abs() < 0.02, "{found:?}");
    }
}
