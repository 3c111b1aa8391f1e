//! Independent blocks of a run, which intervals and bands are based on.

use crate::preprocess::Problem;

/// With fewer segments than these, shorter blocks are used: few blocks do not estimate a scatter.
const FEWEST: usize = 8;

/// The block of every row, and the number of blocks.
///
/// Blocks are whole segments, because an offset or tilt that differs between segments is common to all rows of one
/// segment. Half a segment is no independent evidence. Shorter blocks if there are too few segments for `columns`
/// parameters.
pub fn independent_blocks(problem: &Problem, columns: usize) -> (Vec<usize>, usize) {
    let leg_of_row = legs(problem);
    let count = leg_of_row.last().map_or(0, |last| last + 1);
    if count >= FEWEST.max(2 * columns) { (leg_of_row, count) } else { (problem.block.clone(), problem.blocks) }
}

/// The leg of every row: consecutive rows of one segment and repeat.
pub fn legs(problem: &Problem) -> Vec<usize> {
    let same = |i: usize| problem.segment[i] == problem.segment[i - 1] && problem.repeat[i] == problem.repeat[i - 1];
    let begins = |i: usize| usize::from(i > 0 && !same(i));
    let numbers = (0..problem.rows()).scan(0, |leg, i| {
        *leg += begins(i);
        Some(*leg)
    });
    numbers.collect()
}
