//! Free functions of an axis, as columns: hat functions between knots, separately for each direction where friction
//! can depend on it.

use crate::preprocess::Problem;
use crate::signal::Signal;
use crate::stats::summary::quantile;
use std::f64::consts::TAU;

const ANGLES: usize = 36;
const SPEEDS: usize = 13;
const SLOW_SPEEDS: usize = 4;
/// Range of the slow speed knots, as shares of the fastest speed.
const SLOW: [f64; 2] = [0.003, 0.08];
const LOADS: usize = 10;
const LEVELS: usize = 8;

/// An axis with the columns whose sums represent any function of it, at the rows.
pub struct Functions {
    /// Signals that the function depends on.
    pub over: Vec<Signal>,
    pub columns: Vec<Vec<f32>>,
}

/// Free functions of the axes of a run.
pub fn functions(problem: &Problem) -> Vec<Functions> {
    let view = &problem.view;
    let direction = view.get(Signal::Direction);
    let one = vec![1.0; view.len()];
    let mut all = Vec::new();
    let mut push = |over: Vec<Signal>, hats: Vec<Vec<f64>>| {
        let columns = problem.reduce.apply_all(hats);
        all.push(Functions { over, columns: columns.iter().map(|c| c.iter().map(|v| *v as f32).collect()).collect() });
    };
    if !view.constants.slides {
        let link = view.get(Signal::Link);
        push(vec![Signal::Link, Signal::Direction], around(link, direction));
        push(vec![Signal::Link], around(link, &one));
    }
    let speed = view.map(Signal::Velocity, f64::abs);
    let knots = speeds(view.constants.speeds.unwrap_or_else(|| view.peak(Signal::Velocity)));
    push(vec![Signal::Velocity], hats(&speed, &knots, direction));
    push(vec![Signal::Velocity, Signal::Direction], hats(&speed, &knots, &one));
    if view.bears_load() {
        let driven = view.map2(Signal::Load, Signal::Direction, |load, s| load * s);
        push(vec![Signal::Load, Signal::Direction], hats(&driven, &levels(&driven, LOADS), direction));
    }
    for column in view.points.unknown() {
        let values = view.get(column);
        let knots = levels(values, LEVELS);
        let [rising, falling] = rising_and_falling(values, direction);
        let both = [hats(values, &knots, &rising), hats(values, &knots, &falling)].concat();
        push(vec![column, Signal::Direction], both);
    }
    all
}

/// The direction while a signal rises and while it falls.
fn rising_and_falling(values: &[f64], direction: &[f64]) -> [Vec<f64>; 2] {
    let steps: Vec<f64> =
        (0..values.len()).map(|i| values[(i + 1).min(values.len() - 1)] - values[i.saturating_sub(1)]).collect();
    let usual = quantile(steps.iter().map(|s| s.abs()), 0.5) + 1e-12;
    [1.0, -1.0]
        .map(|way| steps.iter().zip(direction).map(|(s, d)| d * (1.0 + way * (s / usual).tanh()) / 2.0).collect())
}

fn speeds(fastest: f64) -> Vec<f64> {
    let even = (0..SPEEDS).map(|i| fastest * i as f64 / (SPEEDS - 1) as f64);
    let slow = crate::effects::log_grid(SLOW[0] * fastest, SLOW[1] * fastest, SLOW_SPEEDS);
    let mut knots: Vec<f64> = even.chain(slow).collect();
    knots.sort_by(f64::total_cmp);
    knots
}

fn levels(values: &[f64], count: usize) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.iter().step_by(7).copied().collect();
    sorted.sort_by(f64::total_cmp);
    let at = |i: usize| sorted[i * (sorted.len() - 1) / (count - 1)];
    let mut knots: Vec<f64> = if sorted.is_empty() { Vec::new() } else { (0..count).map(at).collect() };
    knots.dedup();
    knots
}

/// Periodic hat functions of an angle.
fn around(angle: &[f64], times: &[f64]) -> Vec<Vec<f64>> {
    let step = TAU / ANGLES as f64;
    let mut hats = vec![vec![0.0; angle.len()]; ANGLES];
    for (i, a) in angle.iter().enumerate() {
        let place = a.rem_euclid(TAU) / step;
        let (low, share) = (place.floor(), place.fract());
        hats[low as usize % ANGLES][i] = (1.0 - share) * times[i];
        hats[(low as usize + 1) % ANGLES][i] = share * times[i];
    }
    hats
}

/// Hat functions between knots, constant beyond the ends.
fn hats(values: &[f64], knots: &[f64], times: &[f64]) -> Vec<Vec<f64>> {
    let mut hats = vec![vec![0.0; values.len()]; knots.len()];
    if knots.len() < 2 {
        return Vec::new();
    }
    for (i, v) in values.iter().enumerate() {
        let low = knots.partition_point(|k| k <= v).clamp(1, knots.len() - 1) - 1;
        let share = ((v - knots[low]) / (knots[low + 1] - knots[low])).clamp(0.0, 1.0);
        hats[low][i] = (1.0 - share) * times[i];
        hats[low + 1][i] = share * times[i];
    }
    hats
}
