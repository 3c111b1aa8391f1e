//! Repeats are accepted only if their inputs agree: different motions with the same repeat number do not estimate
//! noise.

use crate::preprocess::Problem;
use crate::preprocess::design::blocks;
use crate::signal::Signal;
use crate::stats::summary::range;
use crate::thresholds::{PAIRS_EACH_ROW, SAME_ANGLE, SAME_LEVEL, SAME_MOTION};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::f64::consts::TAU;

/// A signal in which repeats must agree.
#[derive(Debug, Clone, Copy)]
pub enum Same {
    Value(Signal),
    /// The absolute value, for either sign.
    Size(Signal),
}

impl Same {
    pub fn signal(self) -> Signal {
        match self {
            Same::Value(signal) | Same::Size(signal) => signal,
        }
    }

    pub fn of(self, values: &[f64]) -> Vec<f64> {
        match self {
            Same::Value(_) => values.to_vec(),
            Same::Size(_) => values.iter().map(|v| v.abs()).collect(),
        }
    }
}

/// Difference of an input between repeats that should agree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DifferentMotion {
    pub signal: Signal,
    /// RMS of the difference of two repeats at the same moment.
    pub apart: f64,
    /// Standard deviation over the run.
    pub spread: f64,
}

/// One input at the rows, with its allowed difference.
struct Input {
    signal: Signal,
    values: Vec<f64>,
    /// A periodic angle.
    turns: bool,
    variance: f64,
    allowed: f64,
}

impl Input {
    fn of(problem: &Problem, same: Same) -> Option<Self> {
        let signal = same.signal();
        let values = problem.reduce.apply(same.of(problem.view.find(signal)?));
        let (mean_square, variance) = moments(&values);
        let is_angle = signal == Signal::Link && !problem.view.constants.slides;
        let (low, high) = range(&values);
        let turns = is_angle && high - low > TAU;
        let variance = if turns { variance.min(TAU * TAU / 12.0) } else { variance };
        // Changes from row to row within a stretch: noise and the motion between the rows.
        let next = (1..values.len()).filter(|i| problem.block[*i] == problem.block[i - 1]);
        let steps: Vec<f64> = next.map(|i| values[i] - values[i - 1]).collect();
        let chatter = moments(&steps).0 / 2.0;
        let level = match signal {
            Signal::Link => 0.0,
            Signal::Load => moments(&problem.target).1.max(mean_square),
            _ => mean_square,
        };
        let allowed = SAME_MOTION * variance + chatter + SAME_LEVEL * SAME_LEVEL * level;
        Some(Self { signal, values, turns, variance, allowed })
    }

    fn half_square(&self, (a, b): (usize, usize)) -> f64 {
        let d = self.values[a] - self.values[b];
        let d = if self.turns { d - (d / TAU).round() * TAU } else { d };
        d * d / 2.0
    }
}

/// Distinguished angles in a turn.
const ANGLES: usize = 90;

/// Pairs of rows.
type RowPairs = Vec<(usize, usize)>;

/// For repeats of a condition that start at different angles: pairs of rows at the same angle if there are enough,
/// and the set of all pairs at different angles. Pairs are thinned, so that every condition counts with the same
/// number of pairs for each row.
pub fn by_angle(
    replicate_pairs: RowPairs,
    condition: &[usize],
    repeat: &[i64],
    link: &[f64],
) -> (RowPairs, HashSet<(usize, usize)>) {
    // For a dwell at an angle, rows are paired by their number within the dwell.
    let mut dwelt: HashMap<(usize, i64, usize), usize> = HashMap::new();
    let place = |row: usize| {
        let angle = (link[row].rem_euclid(TAU) / TAU * ANGLES as f64) as usize;
        let nth = dwelt.entry((condition[row], repeat[row], angle)).or_default();
        *nth += 1;
        angle + ANGLES * *nth
    };
    let places: Vec<usize> = (0..link.len()).map(place).collect();
    let of_condition = |replicate_pairs: RowPairs| {
        let mut pairs: BTreeMap<usize, RowPairs> = BTreeMap::new();
        replicate_pairs.into_iter().for_each(|pair| pairs.entry(condition[pair.0]).or_default().push(pair));
        pairs
    };
    let mut rows: HashMap<usize, f64> = HashMap::new();
    condition.iter().for_each(|c| *rows.entry(*c).or_default() += 1.0);
    let for_each_row = |(c, pairs): (&usize, &RowPairs)| pairs.len() as f64 / rows[c];
    let mut met = of_condition(blocks::replicate_pairs(condition, &places, repeat, 0));
    met.retain(|c, pairs| for_each_row((c, pairs)) >= PAIRS_EACH_ROW);
    let mut all = of_condition(replicate_pairs);
    let elsewhere = all.iter().filter(|(c, _)| !met.contains_key(c)).flat_map(|(_, pairs)| pairs.clone()).collect();
    all.extend(met);
    let fewest = all.iter().map(for_each_row).fold(f64::INFINITY, f64::min).max(PAIRS_EACH_ROW);
    let thinned = |of: (&usize, &RowPairs)| {
        let share = fewest / for_each_row(of);
        let is_kept = |i: &usize| ((i + 1) as f64 * share).floor() > (*i as f64 * share).floor();
        (0..of.1.len()).filter(is_kept).map(|i| of.1[i]).collect::<RowPairs>()
    };
    (all.iter().flat_map(thinned).collect(), elsewhere)
}

/// Whether the angles of the pairs are unrelated.
pub fn are_apart(replicate_pairs: &[(usize, usize)], link: &[f64]) -> bool {
    let apart = |(a, b): &(usize, usize)| {
        let d = link[*a] - link[*b];
        (d - (d / TAU).round() * TAU).powi(2)
    };
    let square = replicate_pairs.iter().map(apart).sum::<f64>() / replicate_pairs.len().max(1) as f64;
    square > SAME_ANGLE * SAME_ANGLE * TAU * TAU / 12.0
}

/// Keeps the replicate pairs of stretches (`of` numbers them for each row) whose inputs agree. If none is left,
/// `different_motion` reports the largest difference.
pub fn check_replicates(problem: &mut Problem, of: &[i64], inputs: &[Same]) {
    if inputs.is_empty() {
        return;
    }
    let inputs: Vec<Input> = inputs.iter().filter_map(|same| Input::of(problem, *same)).collect();
    let mut pairs: BTreeMap<(i64, i64), Vec<(usize, usize)>> = BTreeMap::new();
    for (a, b) in std::mem::take(&mut problem.replicate_pairs) {
        pairs.entry((of[a].min(of[b]), of[a].max(of[b]))).or_default().push((a, b));
    }
    let mut worst: Option<(f64, DifferentMotion)> = None;
    for replicate_pairs in pairs.into_values() {
        let apart = |input: &Input| {
            replicate_pairs.iter().map(|t| input.half_square(*t)).sum::<f64>() / replicate_pairs.len() as f64
        };
        let most =
            inputs.iter().map(|i| (apart(i) / i.allowed.max(f64::MIN_POSITIVE), i)).max_by(|a, b| a.0.total_cmp(&b.0));
        match most.filter(|(times, _)| *times > 1.0) {
            None => problem.replicate_pairs.extend(replicate_pairs),
            Some((times, input)) if worst.is_none_or(|(most, _)| times > most) => {
                let apart = (2.0 * apart(input)).sqrt();
                worst = Some((times, DifferentMotion { signal: input.signal, apart, spread: input.variance.sqrt() }));
            }
            Some(_) => {}
        }
    }
    problem.replicate_pairs.sort_unstable();
    problem.different_motion = worst.map(|w| w.1).filter(|_| problem.replicate_pairs.is_empty());
}

/// Mean square and variance.
fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len().max(1) as f64;
    let (sum, square) = values.iter().fold((0.0, 0.0), |(s, q), v| (s + v, q + v * v));
    (square / n, (square / n - (sum / n).powi(2)).max(0.0))
}
