//! Gram matrices of blocks, from which cross-validation, jackknife and sign flips are computed.

use crate::linear::cholesky::Cholesky;
use crate::thresholds::FOLD_COVERAGE;

/// Σ xxᵀ and Σ xy of each group of rows, and Σ yy.
#[derive(Debug, Clone)]
pub struct BlockGrams {
    /// Number of columns, p.
    pub(crate) columns: usize,
    /// Number of groups.
    pub(crate) groups: usize,
    pub(crate) xx: Vec<f64>,
    pub(crate) xy: Vec<f64>,
    pub(crate) yy: Vec<f64>,
    /// Number of rows of each group.
    pub(crate) rows: Vec<usize>,
}

impl BlockGrams {
    pub(crate) fn empty(columns: usize, rows: Vec<usize>) -> Self {
        Self { columns, groups: rows.len(), xx: Vec::new(), xy: Vec::new(), yy: Vec::new(), rows }
    }

    /// Σ xxᵀ of one group: p·p values, row-major.
    pub fn xx(&self, group: usize) -> &[f64] {
        let size = self.columns * self.columns;
        &self.xx[group * size..(group + 1) * size]
    }

    /// Σ xy of one group: p values.
    pub fn xy(&self, group: usize) -> &[f64] {
        &self.xy[group * self.columns..(group + 1) * self.columns]
    }

    /// Σ xxᵀ and Σ xy over some groups; a group may occur several times.
    pub fn sum(&self, groups: impl IntoIterator<Item = usize>) -> (Vec<f64>, Vec<f64>) {
        let p = self.columns;
        let mut xx = vec![0.0; p * p];
        let mut xy = vec![0.0; p];
        for g in groups {
            xx.iter_mut().zip(self.xx(g)).for_each(|(s, v)| *s += v);
            xy.iter_mut().zip(self.xy(g)).for_each(|(s, v)| *s += v);
        }
        (xx, xy)
    }

    /// Σ xxᵀ (p·p, row-major) and Σ xy (p) over all rows.
    pub fn total(&self) -> (Vec<f64>, Vec<f64>) {
        self.sum(0..self.groups)
    }

    /// Σ yy over all rows.
    pub fn squares(&self) -> f64 {
        self.yy.iter().sum()
    }

    /// Squared error of each group, predicted from all others. A column that the others hardly contain is not used
    /// for the prediction.
    pub fn validation_losses(&self) -> Vec<f64> {
        let p = self.columns;
        let (xx, xy) = self.total();
        let least: Vec<f64> =
            Cholesky::new(&xx, p, 1e-12).orthogonal_squares().map(|square| FOLD_COVERAGE * square).collect();
        (0..self.groups)
            .map(|g| {
                let rest: Vec<f64> = xx.iter().zip(self.xx(g)).map(|(a, b)| a - b).collect();
                let side: Vec<f64> = xy.iter().zip(self.xy(g)).map(|(a, b)| a - b).collect();
                let coefficients = Cholesky::with_min_pivot(&rest, p, 1e-12, &least).solve(&side);
                let mut loss = self.yy[g];
                for a in 0..p {
                    let inner: f64 = (0..p).map(|b| self.xx(g)[a * p + b] * coefficients[b]).sum();
                    loss += coefficients[a] * (inner - 2.0 * self.xy(g)[a]);
                }
                loss.max(0.0)
            })
            .collect()
    }

    /// Effective number of groups of each coefficient: the number of equal groups with the same accuracy, (Σ w)²/Σ w².
    /// The weight w is the share of a group in the variance of the coefficient. `whole` factorizes the total.
    pub fn effective_groups(&self, whole: &Cholesky) -> Vec<f64> {
        let p = self.columns;
        // Columns that are not zero throughout a group. Of the offsets for each power-up, a group has only one.
        let active: Vec<Vec<usize>> =
            (0..self.groups).map(|g| (0..p).filter(|a| self.xx(g)[a * p + a] > 0.0).collect()).collect();
        let of_coefficient = |k: usize| {
            let mut unit = vec![0.0; p];
            unit[k] = 1.0;
            let row = whole.solve(&unit);
            let weight = |g: usize| {
                let (xx, active) = (self.xx(g), &active[g]);
                let along = |a: usize| active.iter().map(|b| xx[a * p + b] * row[*b]).sum::<f64>();
                active.iter().map(|a| row[*a] * along(*a)).sum::<f64>()
            };
            let weights: Vec<f64> = (0..self.groups).map(weight).collect();
            let squares: f64 = weights.iter().map(|w| w * w).sum();
            if squares > 0.0 { weights.iter().sum::<f64>().powi(2) / squares } else { 1.0 }
        };
        (0..p).map(of_coefficient).collect()
    }

    /// Solution of the whole without each group in turn.
    pub fn jackknife(&self) -> Vec<Vec<f64>> {
        let (xx, xy) = self.total();
        (0..self.groups)
            .filter(|g| self.rows[*g] > 0)
            .map(|g| {
                let rest: Vec<f64> = xx.iter().zip(self.xx(g)).map(|(a, b)| a - b).collect();
                let side: Vec<f64> = xy.iter().zip(self.xy(g)).map(|(a, b)| a - b).collect();
                Cholesky::new(&rest, self.columns, 0.0).solve(&side)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dependent_column_is_left_at_zero() {
        let a = [4.0, 2.0, 4.0, 2.0, 3.0, 2.0, 4.0, 2.0, 4.0];
        let spd = Cholesky::new(&a, 3, 0.0);
        assert!(spd.is_dependent(2) && !spd.is_dependent(1));
        let x = spd.solve(&[8.0, 5.0, 8.0]);
        assert!((4.0 * x[0] + 2.0 * x[1] - 8.0).abs() < 1e-9 && x[2] == 0.0, "{x:?}");
    }

    #[test]
    fn equal_groups_count_fully_and_a_single_one_that_decides_counts_as_one() {
        let x: Vec<f64> = (0..12).map(|i| f64::from(i % 4) - 1.5).collect();
        let only: Vec<f64> = x.iter().enumerate().map(|(i, x)| if i < 4 { x * x } else { 0.0 }).collect();
        let group: Vec<usize> = (0..12).map(|i| i / 4).collect();
        let grams = BlockGrams::new(&[&x, &only], &x, &group, 3);
        let effective = grams.effective_groups(&Cholesky::new(&grams.total().0, 2, 0.0));
        assert!((effective[0] - 3.0).abs() < 1e-9 && (effective[1] - 1.0).abs() < 1e-9, "{effective:?}");
    }

    #[test]
    fn what_only_one_group_shows_the_others_do_not_predict() {
        // The second column differs from the first in the third group only, except for noise.
        let x: Vec<f64> = (0..12).map(|i| f64::from(i % 4) - 1.0).collect();
        let play: Vec<f64> =
            (0..12).map(|i| x[i] + if i >= 8 { x[i].powi(2) } else { 0.02 * (i as f64 * 2.3).sin() }).collect();
        let y: Vec<f64> = (0..12).map(|i| x[i] + 0.1 * (i as f64 * 1.7).sin()).collect();
        let group: Vec<usize> = (0..12).map(|i| i / 4).collect();
        let of = |columns: &[&[f64]]| BlockGrams::new(columns, &y, &group, 3).validation_losses();
        let (with, without) = (of(&[&x, &play]), of(&[&x]));
        assert!((with[2] - without[2]).abs() < 1e-9, "{with:?} {without:?}");
        assert!((with[0] - without[0]).abs() > 1e-6, "where the third group is known, the column counts");
    }

    #[test]
    fn validation_error_is_that_of_a_refit() {
        let x: Vec<f64> = (0..12).map(|i| f64::from(i) * 0.3 - 1.0).collect();
        let y: Vec<f64> = x.iter().enumerate().map(|(i, x)| 2.0 * x + (i as f64 * 1.7).sin()).collect();
        let group: Vec<usize> = (0..12).map(|i| i / 4).collect();
        let grams = BlockGrams::new(&[&x], &y, &group, 3);
        let slope = |keep: &dyn Fn(usize) -> bool| {
            let pairs = || x.iter().zip(&y).enumerate().filter(|(i, _)| keep(*i)).map(|(_, p)| p);
            pairs().map(|(x, y)| x * y).sum::<f64>() / pairs().map(|(x, _)| x * x).sum::<f64>()
        };
        let b = slope(&|i| i / 4 != 1);
        let loss: f64 = (4..8).map(|i| (y[i] - b * x[i]).powi(2)).sum();
        assert!((grams.validation_losses()[1] - loss).abs() < 1e-9);
        assert!((grams.jackknife()[1][0] - b).abs() < 1e-9);
    }
}
