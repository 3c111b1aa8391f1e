//! Design of the data: rows to blocks, folds and replicate pairs.

use crate::thresholds::RANGE_MARGIN;
use std::collections::{BTreeSet, HashMap};

/// Divides groups of consecutive rows into blocks of about equal length, so that a slow trend is not contained in one
/// block.
///
/// `group` numbers stretches of consecutive rows. Returns the block of every row and the number of blocks.
pub fn blocks(group: &[usize], least: usize) -> (Vec<usize>, usize) {
    let mut lengths: Vec<(usize, usize)> = Vec::new();
    for g in group {
        match lengths.last_mut() {
            Some((last, n)) if last == g => *n += 1,
            _ => lengths.push((*g, 1)),
        }
    }
    let mut sorted: Vec<usize> = lengths.iter().map(|l| l.1).collect();
    sorted.sort_unstable();
    let middle = sorted.get(sorted.len() / 2).copied().unwrap_or(1);
    let length = middle.min(group.len() / least).max(4);
    let mut block = Vec::with_capacity(group.len());
    let mut next = 0;
    for (_, n) in lengths {
        let parts = ((n as f64 / length as f64).round() as usize).max(1);
        block.extend((0..n).map(|i| next + i * parts / n));
        next += parts;
    }
    (block, next)
}

/// Clusters close values: a gap wider than `tolerance(value)` starts a new cluster.
pub fn clusters(values: &[f64], tolerance: impl Fn(f64) -> f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut cluster = vec![0; values.len()];
    let mut number = 0;
    for pair in order.windows(2) {
        if values[pair[1]] - values[pair[0]] > tolerance(values[pair[1]]) {
            number += 1;
        }
        cluster[pair[1]] = number;
    }
    cluster
}

/// With fewer conditions than these a condition is not predicted by its neighbours.
const NEIGHBOURS: usize = 12;

/// Folds from conditions: every n-th condition together, so that neighbouring conditions predict each fold.
///
/// With fewer conditions than a dozen this is not possible, and a first magnetisation or warm-up occurs only once.
/// Then every n-th stretch of a block is left out, and the rest of the block is kept.
pub fn folds(condition: &[usize], block: &[usize], most: usize) -> (Vec<usize>, usize) {
    let conditions = condition.iter().max().map_or(0, |c| c + 1);
    if conditions >= NEIGHBOURS {
        let n = conditions.min(most);
        return (condition.iter().map(|c| c % n).collect(), n);
    }
    let blocks = block.iter().max().map_or(0, |b| b + 1);
    let stretch = (block.len() / (blocks * most).max(1)).max(4);
    let n = most.min(block.len() / stretch).max(1);
    ((0..block.len()).map(|i| i / stretch % n).collect(), n)
}

/// The unit that is left out together: a condition with its repeats. With few conditions it is a stretch of
/// consecutive rows (`group`), which its repeats predict. The rest of a stretch would predict a part of it by the
/// individual error of that stretch.
pub fn left_out_unit<'a>(condition: &'a [usize], group: &'a [usize]) -> &'a [usize] {
    let count = |of: &[usize]| of.iter().max().map_or(0, |c| c + 1);
    let is_few = count(condition) < NEIGHBOURS && count(group) >= NEIGHBOURS.max(2 * count(condition));
    if is_few { group } else { condition }
}

/// Distributes stretches (`group`) whose values exceed the range of all other folds over several folds, because other
/// stretches cannot predict them.
pub fn share_edges(fold: &mut [usize], folds: usize, group: &[usize], values: &[f64]) {
    let range = |without: Option<usize>| {
        let held = values.iter().zip(fold.iter()).filter(|(_, f)| Some(**f) != without).map(|(v, _)| *v);
        held.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)))
    };
    let (low, high) = range(None);
    let margin = RANGE_MARGIN * (high - low);
    let others: Vec<(f64, f64)> = (0..folds).map(|f| range(Some(f))).collect();
    let is_beyond = |row: usize| {
        let (low, high) = others[fold[row]];
        values[row] < low - margin || values[row] > high + margin
    };
    let alone: BTreeSet<usize> = (0..fold.len()).filter(|row| is_beyond(*row)).map(|row| group[row]).collect();
    let rows: Vec<usize> = (0..fold.len()).filter(|row| alone.contains(&group[*row])).collect();
    let stretch = (rows.len() / (4 * folds)).max(4);
    rows.into_iter().enumerate().for_each(|(i, row)| fold[row] = i / stretch % folds);
}

/// Largest number of pairs for each row: more pairs of the same repeats add no information.
const MOST_REPLICATES: usize = 8;

/// Pairs of rows of the same condition in different repeats whose phases differ by `apart` rows.
///
/// For chunks, neighbouring phases are paired instead of equal ones. A change from chunk to chunk is no repeatable
/// effect of the joint. An example is the ripple of a control loop that starts alike in every repeat.
pub fn replicate_pairs(condition: &[usize], phase: &[usize], repeat: &[i64], apart: usize) -> Vec<(usize, usize)> {
    let mut seen: HashMap<(usize, usize), Vec<usize>> = HashMap::new();
    for row in 0..condition.len() {
        seen.entry((condition[row], phase[row])).or_default().push(row);
    }
    let mut pairs = Vec::new();
    for row in 0..condition.len() {
        let Some(others) = seen.get(&(condition[row], phase[row] + apart)) else { continue };
        let is_replicate = |r: &&usize| repeat[**r] != repeat[row] && (apart > 0 || **r > row);
        let (before, after) = others.split_at(others.partition_point(|r| *r <= row));
        pairs.extend(after.iter().chain(before).filter(is_replicate).take(MOST_REPLICATES).map(|r| (row, *r)));
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_segment_becomes_several_blocks() {
        let group: Vec<usize> = (0..40)
            .map(|i| {
                if i < 10 {
                    0
                } else if i < 20 {
                    1
                } else {
                    2
                }
            })
            .collect();
        let (block, n) = blocks(&group, 4);
        assert_eq!((n, block[0], block[19], block[20], block[39]), (4, 0, 1, 2, 3));
    }

    #[test]
    fn close_values_are_one_condition() {
        assert_eq!(clusters(&[1.0, 5.0, 1.01, 5.02, -3.0], |_| 0.1), vec![1, 2, 1, 2, 0]);
    }

    #[test]
    fn legs_are_left_out_whole_with_few_conditions() {
        let of = |conditions: usize, legs: usize| {
            let group: Vec<usize> = (0..10 * legs).map(|row| row / 10).collect();
            let condition: Vec<usize> = group.iter().map(|g| g % conditions).collect();
            left_out_unit(&condition, &group) == group
        };
        assert!(of(4, 12) && of(6, 24));
        assert!(!of(4, 8) && !of(8, 12) && !of(12, 36), "too few legs, hardly a repeat, conditions enough");
    }

    #[test]
    fn a_stretch_beyond_the_range_of_all_others_is_left_out_in_parts() {
        let group: Vec<usize> = (0..120).map(|row| row / 20).collect();
        let given: Vec<usize> = group.iter().map(|g| g % 3).collect();
        let loops = |largest: f64| -> Vec<f64> {
            let peak = |g: usize| if g == 4 { largest } else { 0.5 };
            (0..120).map(|row| peak(row / 20) * (row % 20) as f64 / 19.0).collect()
        };
        let shared = |largest: f64| {
            let mut fold = given.clone();
            share_edges(&mut fold, 3, &group, &loops(largest));
            fold
        };
        assert_eq!(shared(0.5), given);
        let fold = shared(0.6);
        assert_eq!((&fold[..80], &fold[100..]), (&given[..80], &given[100..]));
        assert!((0..3).all(|f| fold[80..100].contains(&f)), "{:?}", &fold[80..100]);
    }

    #[test]
    fn replicates_are_of_different_repeats() {
        assert_eq!(replicate_pairs(&[0, 0, 0, 0], &[0, 1, 0, 1], &[0, 0, 1, 1], 0), vec![(0, 2), (1, 3)]);
        assert_eq!(replicate_pairs(&[0, 0, 0, 0], &[0, 1, 0, 1], &[0, 0, 1, 1], 1), vec![(0, 3), (2, 1)]);
    }
}
