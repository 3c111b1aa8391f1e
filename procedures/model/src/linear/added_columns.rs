//! Candidate columns added to a blocked ridge regression: their error reduction in the whole run and in each left-out
//! block.

use crate::linear::basis::dot;
use crate::linear::blocked_ridge::{BlockedRidge, FREE, Fold, Sums, times};
use crate::linear::cholesky::Cholesky;
use std::ops::Range;

/// Products of columns with each other and with the response.
type Normal = (Vec<f64>, Vec<f64>);

/// Candidate columns orthogonalized against a base, as sums of products: for the fit without each block, and for that
/// block.
pub struct Added {
    pub size: usize,
    /// Products of the orthogonalized columns with themselves and with the response.
    gram: Vec<f64>,
    side: Vec<f64>,
    /// Tolerance: share of the columns that is orthogonal to the base.
    pub visible: f64,
    /// The same without each block, and for that block alone.
    without: Vec<Normal>,
    validation_losses: Vec<Normal>,
    /// The same for each block, orthogonalized by the fit of the whole run.
    within: Vec<Normal>,
    diagonal: Vec<f64>,
}

impl Added {
    pub fn new(ridge: &BlockedRidge, columns: &[impl AsRef<[f32]>]) -> Self {
        let weighted =
            |c: &[f32]| -> Vec<f64> { c.iter().zip(&ridge.weight).map(|(v, w)| f64::from(*v) * w).collect() };
        let columns: Vec<Vec<f64>> = columns.iter().map(|c| weighted(c.as_ref())).collect();
        let (k, p) = (columns.len(), ridge.base.len());
        let sums: Vec<Products> = ridge.blocks.iter().map(|rows| Products::of(ridge, &columns, rows)).collect();
        let mut all = Products::none(k, p);
        sums.iter().for_each(|s| all.add(s, 1.0));
        let solved =
            |fold: &Fold, of: &Products| -> Vec<Vec<f64>> { of.jb.iter().map(|jb| times(&fold.inverse, jb)).collect() };
        // In the whole run: from the residual of the columns, because the penalty shrinks only a part of the base.
        let along = solved(&ridge.whole, &all);
        let (gram, side) = all.projected(&along, &ridge.whole.coefficients);
        let diagonal: Vec<f64> = (0..k).map(|a| all.jj[a * k + a]).collect();
        let visible =
            (0..k).map(|a| gram[a * k + a] / diagonal[a].max(f64::MIN_POSITIVE)).fold(f64::INFINITY, f64::min);
        let mut out = Self {
            size: k,
            gram,
            side,
            visible,
            without: Vec::with_capacity(sums.len()),
            validation_losses: Vec::with_capacity(sums.len()),
            within: Vec::with_capacity(sums.len()),
            diagonal,
        };
        for ((part, each), fold) in sums.iter().zip(&ridge.each).zip(&ridge.folds) {
            let rest = all.without(part);
            let of_fold = solved(fold, &rest);
            out.without.push(rest.projected(&of_fold, &fold.coefficients));
            out.validation_losses.push(part.left(each, &of_fold, &fold.coefficients));
            out.within.push(part.left(each, &along, &ridge.whole.coefficients));
        }
        out
    }

    /// Coefficients in the whole run.
    pub fn coefficients(&self) -> Vec<f64> {
        Cholesky::new(&self.gram, self.size, 1e-12).solve(&self.side)
    }

    /// Weighted squared error that the columns explain in the whole run.
    pub fn taken(&self) -> f64 {
        dot(&self.coefficients(), &self.side)
    }

    /// Squared norm of the orthogonal part of each column.
    pub fn squares(&self) -> impl Iterator<Item = f64> {
        (0..self.size).map(|a| self.gram[a * self.size + a])
    }

    /// Wald statistic of the coefficients, with the scatter of whole blocks under the alternative.
    pub fn wald(&self) -> f64 {
        let covariance = self.scatter(&self.coefficients());
        let white = Cholesky::new(&covariance, self.size, 1e-12).whiten(&self.side);
        dot(&white, &white)
    }

    /// Covariance of the products of the columns with the residual for these coefficients.
    pub fn scatter(&self, coefficients: &[f64]) -> Vec<f64> {
        let k = self.size;
        let mut covariance = vec![0.0; k * k];
        for (gram, side) in &self.within {
            let left: Vec<f64> = side.iter().zip(times(gram, coefficients)).map(|(s, t)| s - t).collect();
            (0..k * k).for_each(|at| covariance[at] += left[at / k] * left[at % k]);
        }
        let groups = self.within.len() as f64;
        covariance.iter_mut().for_each(|c| *c *= groups / (groups - 1.0));
        covariance
    }

    /// Reduction of the squared error in each left-out block, with coefficients fitted to the other blocks, and the
    /// reduction in those. `strength` is a ridge penalty; coefficients that `allows` rejects are zero.
    pub fn gains(&self, strength: f64, allows: impl Fn(&[f64]) -> bool) -> Vec<Gain> {
        let k = self.size;
        let gain = |((gram, side), (there, side_there)): (&Normal, &Normal)| {
            let mut gram = gram.clone();
            (0..k).for_each(|a| gram[a * k + a] += (strength + FREE) * self.diagonal[a]);
            let coefficients = Cholesky::new(&gram, k, 1e-12).solve(side);
            if !allows(&coefficients) {
                return Gain { validation_losses: 0.0, fitted: 0.0 };
            }
            let validation_losses =
                2.0 * dot(&coefficients, side_there) - dot(&coefficients, &times(there, &coefficients));
            Gain { validation_losses, fitted: dot(&coefficients, side) }
        };
        self.without.iter().zip(&self.validation_losses).map(gain).collect()
    }
}

/// Reduction of the squared error in one block, and in the other blocks that the coefficients were fitted to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    pub validation_losses: f64,
    pub fitted: f64,
}

/// Products of some columns over some rows.
struct Products {
    jj: Vec<f64>,
    jb: Vec<Vec<f64>>,
    jy: Vec<f64>,
}

impl Products {
    fn none(k: usize, p: usize) -> Self {
        Self { jj: vec![0.0; k * k], jb: vec![vec![0.0; p]; k], jy: vec![0.0; k] }
    }

    fn of(ridge: &BlockedRidge, columns: &[Vec<f64>], rows: &Range<usize>) -> Self {
        let k = columns.len();
        let part = |column: &Vec<f64>| column[rows.clone()].to_vec();
        let columns: Vec<Vec<f64>> = columns.iter().map(part).collect();
        let mut jj = vec![0.0; k * k];
        for a in 0..k {
            for b in 0..=a {
                jj[a * k + b] = dot(&columns[a], &columns[b]);
                jj[b * k + a] = jj[a * k + b];
            }
        }
        let with_base = |c: &Vec<f64>| ridge.base.iter().map(|b| dot(c, &b[rows.clone()])).collect();
        Self {
            jj,
            jb: columns.iter().map(with_base).collect(),
            jy: columns.iter().map(|c| dot(c, &ridge.response[rows.clone()])).collect(),
        }
    }

    fn add(&mut self, other: &Products, times: f64) {
        let add = |a: &mut Vec<f64>, b: &Vec<f64>| a.iter_mut().zip(b).for_each(|(a, b)| *a += times * b);
        add(&mut self.jj, &other.jj);
        add(&mut self.jy, &other.jy);
        self.jb.iter_mut().zip(&other.jb).for_each(|(a, b)| add(a, b));
    }

    fn without(&self, part: &Products) -> Self {
        let mut rest = Self { jj: self.jj.clone(), jb: self.jb.clone(), jy: self.jy.clone() };
        rest.add(part, -1.0);
        rest
    }

    /// Products of the orthogonal part of the columns, with base coefficients `along` for the columns and `coefficients`
    /// for the response.
    fn projected(&self, along: &[Vec<f64>], coefficients: &[f64]) -> Normal {
        let k = along.len();
        let gram = (0..k * k).map(|at| self.jj[at] - dot(&self.jb[at / k], &along[at % k])).collect();
        let side = (0..k).map(|a| self.jy[a] - dot(&self.jb[a], coefficients)).collect();
        (gram, side)
    }

    /// The same over rows that were left out of the fit of these coefficients.
    fn left(&self, base: &Sums, along: &[Vec<f64>], coefficients: &[f64]) -> Normal {
        let k = along.len();
        let inner: Vec<Vec<f64>> = along.iter().map(|a| times(&base.bb, a)).collect();
        let gram = (0..k * k).map(|at| {
            let (a, b) = (at / k, at % k);
            self.jj[at] - dot(&along[a], &self.jb[b]) - dot(&self.jb[a], &along[b]) + dot(&inner[a], &along[b])
        });
        let side = (0..k).map(|a| {
            self.jy[a] - dot(&along[a], &base.by) - dot(&self.jb[a], coefficients) + dot(&inner[a], coefficients)
        });
        (gram.collect(), side.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::blocked_ridge::BaseColumn;

    fn column(frequency: f64) -> Vec<f64> {
        (0..240).map(|i| (frequency * f64::from(i)).sin()).collect()
    }

    #[test]
    fn a_gain_is_that_of_refits_without_each_block() {
        let (base, other, noise) = (column(0.3), column(0.7), column(2.9));
        let y: Vec<f64> = (0..240).map(|i| 2.0 * base[i] + 0.5 * other[i] + 0.3 * noise[i]).collect();
        let block: Vec<usize> = (0..240).map(|i| i / 30).collect();
        let free = |values| BaseColumn { values, scale: 1.0, is_penalised: false };
        let weight = vec![1.0; 240];
        let alone = BlockedRidge::new(&[free(&base)], &y, &weight, &block, None);
        let both = BlockedRidge::new(&[free(&base), free(&other)], &y, &weight, &block, None);
        let single: Vec<f32> = other.iter().map(|v| *v as f32).collect();
        let added = Added::new(&alone, &[single]);
        for ((gain, was), is) in added.gains(0.0, |_| true).iter().zip(&alone.losses).zip(&both.losses) {
            assert!((was - gain.validation_losses - is).abs() < 1e-4 * was, "{was} {gain:?} {is}");
        }
        assert!((added.coefficients()[0] - both.coefficients()[1]).abs() < 1e-5);
        assert!(added.wald() > 100.0);
    }
}
