//! Pieces of a run that may be called independent: what intervals and bands count.

use crate::prepare::Problem;

/// Below this many segments a run is cut into blocks instead: too few pieces have no scatter of their own.
const FEWEST: usize = 8;

/// The piece of every row, and how many there are.
///
/// Whole segments, because an offset or a tilt that differs from segment to segment is shared by all rows of one, and
/// half a segment is no new evidence. Blocks where there are not enough segments for `columns` parameters.
pub fn pieces(problem: &Problem, columns: usize) -> (Vec<usize>, usize) {
    let mut piece = Vec::with_capacity(problem.rows());
    let mut next = 0;
    for i in 0..problem.rows() {
        let same = i > 0 && problem.segment[i] == problem.segment[i - 1] && problem.repeat[i] == problem.repeat[i - 1];
        next += usize::from(i > 0 && !same);
        piece.push(next);
    }
    let count = next + 1;
    if count >= FEWEST.max(2 * columns) { (piece, count) } else { (problem.block.clone(), problem.blocks) }
}
