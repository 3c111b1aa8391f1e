//! Pieces of a run that may be called independent: what intervals and bands count.

use crate::preprocess::Problem;

/// Below this many segments a run is cut into blocks instead: too few pieces have no scatter of their own.
const FEWEST: usize = 8;

/// The piece of every row, and how many there are.
///
/// Whole segments, because an offset or a tilt that differs from segment to segment is shared by all rows of one, and
/// half a segment is no new evidence. Blocks where there are not enough segments for `columns` parameters.
pub fn pieces(problem: &Problem, columns: usize) -> (Vec<usize>, usize) {
    let piece = legs(problem);
    let count = piece.last().map_or(0, |last| last + 1);
    if count >= FEWEST.max(2 * columns) { (piece, count) } else { (problem.block.clone(), problem.blocks) }
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
