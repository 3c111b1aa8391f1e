//! The residual over one or two axes: means with confidence bands, and the error reduction by a function of the axes.

use crate::linear::basis::dot;
use crate::preprocess::Problem;
use crate::residual_analysis::maps::binned_axis::BinnedAxis;
use crate::stats::student;
use crate::thresholds::DRIVE_AXIS;

/// Rows sorted into the cells of one axis, or of two.
#[derive(Debug, Clone)]
pub struct Map {
    pub x: BinnedAxis,
    pub y: Option<BinnedAxis>,
    /// Cells with rows, in the order of x and then y.
    pub cells: Vec<Cell>,
    /// Cross-validated R²: share of the squared residual that the cell means remove on rows that were not averaged.
    pub explained_share: f64,
}

/// Mean residual in one cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    pub x: usize,
    pub y: usize,
    pub mean: f64,
    /// Standard error over the blocks in the cell. `None` with fewer than three blocks, which do not estimate a
    /// scatter.
    error: Option<f64>,
    pub blocks: usize,
    pub rows: usize,
}

impl Map {
    pub fn new(x: BinnedAxis, y: Option<BinnedAxis>, problem: &Problem, block: &[usize], residual: &[f64]) -> Self {
        let width = y.as_ref().map_or(1, |y| y.bins.len());
        let cell: Vec<usize> =
            (0..residual.len()).map(|i| x.bin[i] * width + y.as_ref().map_or(0, |y| y.bin[i])).collect();
        let count = x.bins.len() * width;
        let cells = statistics(&cell, count, block, residual)
            .into_iter()
            .enumerate()
            .filter_map(|(c, (mean, error, blocks, rows))| {
                (rows > 0).then_some(Cell { x: c / width, y: c % width, mean, error, blocks, rows })
            })
            .collect();
        // A function of set points cannot predict a set point that is left out with all its repeats, so that single
        // blocks are left out. A quantity that varies within each block is validated by folds over all set points.
        let is_held = x.is_held && y.as_ref().is_none_or(|y| y.is_held);
        let explained_share = validated_share(&cell, count, if is_held { block } else { &problem.fold }, residual);
        Self { x, y, cells, explained_share }
    }

    /// Ranking score of the map. The torque of the drive follows from the motion, so that its map is ranked lower.
    pub fn ranking_score(&self) -> f64 {
        let is_drive = std::iter::once(&self.x).chain(&self.y).any(|s| s.name == "motor_torque_nm");
        if is_drive { DRIVE_AXIS * self.explained_share } else { self.explained_share }
    }
}

impl Cell {
    /// Half width of a band that holds for `many` cells together (Bonferroni), for any correlation between the cells.
    pub fn half_width(&self, alpha: f64, many: usize) -> Option<f64> {
        Some(self.error? * student::quantile((self.blocks - 1) as f64, 1.0 - alpha / (2.0 * many.max(1) as f64))?)
    }
}

/// Mean, standard error over the blocks, number of blocks and number of rows of every cell. The rows of a block are
/// consecutive.
fn statistics(
    cell: &[usize],
    count: usize,
    block: &[usize],
    residual: &[f64],
) -> Vec<(f64, Option<f64>, usize, usize)> {
    let mut all = vec![(0.0, 0usize); count];
    for (c, e) in cell.iter().zip(residual) {
        all[*c].0 += e;
        all[*c].1 += 1;
    }
    let mean = |c: usize| all[c].0 / all[c].1.max(1) as f64;
    let mut spread = vec![(0.0, 0usize); count];
    let mut sums: Vec<Option<f64>> = vec![None; count];
    let mut passed: Vec<usize> = Vec::new();
    let mut at = 0;
    for rows in block.chunk_by(|a, b| a == b) {
        for i in at..at + rows.len() {
            let c = cell[i];
            let sum = sums[c].get_or_insert_with(|| {
                passed.push(c);
                0.0
            });
            *sum += residual[i] - mean(c);
        }
        at += rows.len();
        for c in passed.drain(..) {
            spread[c].0 += sums[c].take().unwrap_or_default().powi(2);
            spread[c].1 += 1;
        }
    }
    (0..count)
        .map(|c| {
            let ((square, blocks), rows) = (spread[c], all[c].1);
            let g = blocks as f64;
            let error = (blocks >= 3).then(|| (square * g / (g - 1.0)).sqrt() / rows as f64);
            (mean(c), error, blocks, rows)
        })
        .collect()
}

/// Share of the squared error of each part that cell means from the other parts remove.
fn validated_share(cell: &[usize], count: usize, part: &[usize], residual: &[f64]) -> f64 {
    let sse = dot(residual, residual);
    let mut all = vec![(0.0, 0.0); count];
    let mut parts = vec![(0.0, 0.0); count * part.iter().max().map_or(0, |last| last + 1)];
    for (i, c) in cell.iter().enumerate() {
        for (sum, n) in [&mut all[*c], &mut parts[part[i] * count + c]] {
            *sum += residual[i];
            *n += 1.0;
        }
    }
    let mut saved = 0.0;
    for (at, (sum, n)) in parts.iter().enumerate() {
        let (total, rows) = all[at % count];
        if *n > 0.0 && rows > *n {
            let predicted = (total - sum) / (rows - n);
            saved += 2.0 * predicted * sum - n * predicted * predicted;
        }
    }
    if sse > 0.0 { saved / sse } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_cell_follows_the_scatter_of_its_blocks() {
        let (cell, block) = ([0, 0, 1, 0, 0, 0], [0, 0, 0, 1, 1, 2]);
        let found = statistics(&cell, 3, &block, &[1.0, 1.0, 9.0, 3.0, 3.0, 2.0]);
        let (mean, error, blocks, rows) = found[0];
        assert_eq!((mean, blocks, rows), (2.0, 3, 5));
        // Sums of the blocks about the mean: −2, 2, 0.
        assert!((error.unwrap() - (8.0f64 * 3.0 / 2.0).sqrt() / 5.0).abs() < 1e-12);
        assert_eq!(found[1], (9.0, None, 1, 1), "one piece says nothing about the next");
        assert_eq!(found[2].3, 0);
    }
}
