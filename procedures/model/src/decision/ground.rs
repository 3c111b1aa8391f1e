//! A base of columns projected out of a response, over the whole run and without each of its blocks in turn.
//!
//! Rows are touched once: everything that follows is made of sums of products over blocks.

use crate::linear::basis::dot;
use crate::linear::cholesky::Cholesky;
use rayon::prelude::*;
use std::ops::Range;

/// Strengths that are tried for columns that are held near zero, as shares of the rows.
const RIDGES: [f64; 7] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0];
/// What keeps the others solvable.
const FREE: f64 = 1e-9;

/// A column of the base.
#[derive(Clone, Copy)]
pub struct BaseColumn<'a> {
    pub values: &'a [f64],
    /// Size by which it is held near zero.
    pub scale: f64,
    pub shrinks: bool,
}

/// Sums of products over some rows: of the base with itself and with the response, and of the response.
#[derive(Clone)]
struct Sums {
    bb: Vec<f64>,
    by: Vec<f64>,
    yy: f64,
}

/// Products of columns with each other and with the response.
type Normal = (Vec<f64>, Vec<f64>);

/// The base without one block.
struct Fold {
    /// Inverse of the products of the base: a base is solved for hundreds of columns.
    inverse: Vec<f64>,
    /// Factors of the base for the response.
    factors: Vec<f64>,
}

pub struct Ground {
    /// Rows of each block.
    pub blocks: Vec<Range<usize>>,
    weight: Vec<f64>,
    base: Vec<Vec<f64>>,
    scale: Vec<f64>,
    response: Vec<f64>,
    /// Weighted residual of the base.
    left: Vec<f64>,
    each: Vec<Sums>,
    folds: Vec<Fold>,
    whole: Fold,
    /// Strength of what is held near zero, as a share of the rows.
    pub ridge: f64,
    /// Held-out weighted squared error of each block.
    pub losses: Vec<f64>,
}

/// Rows of equal block numbers.
pub fn ranges(block: &[usize]) -> Vec<Range<usize>> {
    let mut end = 0;
    let range = |rows: &[usize]| {
        end += rows.len();
        end - rows.len()..end
    };
    block.chunk_by(|a, b| a == b).map(range).collect()
}

impl Ground {
    /// `ridge`: the strength, or the one of [`RIDGES`] that predicts held-out blocks best.
    pub fn new(columns: &[BaseColumn], response: &[f64], weight: &[f64], block: &[usize], ridge: Option<f64>) -> Self {
        let blocks = ranges(block);
        let scale: Vec<f64> = columns.iter().map(|c| c.scale.max(f64::MIN_POSITIVE)).collect();
        let weighted =
            |values: &[f64], by: f64| -> Vec<f64> { values.iter().zip(weight).map(|(v, w)| v * w / by).collect() };
        let base: Vec<Vec<f64>> = columns.iter().zip(&scale).map(|(c, scale)| weighted(c.values, *scale)).collect();
        let response = weighted(response, 1.0);
        let each: Vec<Sums> = blocks.iter().map(|rows| Sums::of(&base, &response, rows)).collect();
        let mut all = each[0].clone();
        each[1..].iter().for_each(|sums| all.add(sums, 1.0));
        let n = response.len() as f64;
        let penalty =
            |ridge: f64| -> Vec<f64> { columns.iter().map(|c| if c.shrinks { ridge } else { FREE } * n).collect() };
        let shrinks = columns.iter().any(|c| c.shrinks);
        let loss = |ridge: f64| -> f64 {
            let penalty = penalty(ridge);
            each.par_iter().map(|sums| sums.loss(&all.without(sums).factors(&penalty))).sum()
        };
        let ridge = ridge.unwrap_or_else(|| {
            let tried = RIDGES.iter().filter(|_| shrinks).map(|ridge| (*ridge, loss(*ridge)));
            tried.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(1.0, |best| best.0)
        });
        let penalty = penalty(ridge);
        let folds: Vec<Fold> = each.par_iter().map(|sums| all.without(sums).fold(&penalty)).collect();
        let losses = each.iter().zip(&folds).map(|(sums, fold)| sums.loss(&fold.factors)).collect();
        let whole = all.fold(&penalty);
        let mut left = response.clone();
        for (base, factor) in base.iter().zip(&whole.factors) {
            left.iter_mut().zip(base).for_each(|(e, b)| *e -= factor * b);
        }
        Self { blocks, weight: weight.to_vec(), base, scale, response, left, each, folds, whole, ridge, losses }
    }

    pub fn loss(&self) -> f64 {
        self.losses.iter().sum()
    }

    /// Factors of the columns as they were given, over all rows.
    pub fn factors(&self) -> Vec<f64> {
        self.whole.factors.iter().zip(&self.scale).map(|(f, s)| f / s).collect()
    }

    /// The same without each block in turn.
    pub fn replicates(&self) -> impl Iterator<Item = Vec<f64>> {
        self.folds.iter().map(|fold| fold.factors.iter().zip(&self.scale).map(|(f, s)| f / s).collect())
    }

    /// Weighted squared error that columns with these factors take off the rows that are not `near`, and what is left there
    /// without them.
    pub fn taken_outside(&self, columns: &[Vec<f32>], factors: &[f64], near: &[bool]) -> (f64, f64) {
        let weighted = |values: &[f32]| values.iter().zip(&self.weight).map(|(v, w)| f64::from(*v) * w).collect();
        let mut sum = vec![0.0; self.response.len()];
        for (column, factor) in columns.iter().zip(factors) {
            let own: Vec<f64> = self.rest(weighted(column));
            sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += factor * own);
        }
        let outside = sum.iter().zip(&self.left).zip(near).filter(|(_, near)| !**near).map(|(pair, _)| pair);
        outside.fold((0.0, 0.0), |(taken, left), (own, e)| (taken + own * (2.0 * e - own), left + e * e))
    }

    /// What a column has beside the base.
    fn rest(&self, mut own: Vec<f64>) -> Vec<f64> {
        let side: Vec<f64> = self.base.iter().map(|b| dot(b, &own)).collect();
        for (base, factor) in self.base.iter().zip(times(&self.whole.inverse, &side)) {
            own.iter_mut().zip(base).for_each(|(o, b)| *o -= factor * b);
        }
        own
    }

    /// What columns would add, beside the base.
    pub fn added(&self, columns: &[impl AsRef<[f32]>]) -> Added {
        let columns: Vec<Vec<f64>> = columns
            .iter()
            .map(|c| c.as_ref().iter().zip(&self.weight).map(|(v, w)| f64::from(*v) * w).collect())
            .collect();
        Added::new(self, &columns)
    }
}

impl Sums {
    fn of(base: &[Vec<f64>], response: &[f64], rows: &Range<usize>) -> Self {
        let p = base.len();
        let mut bb = vec![0.0; p * p];
        for a in 0..p {
            for b in 0..=a {
                bb[a * p + b] = dot(&base[a][rows.clone()], &base[b][rows.clone()]);
                bb[b * p + a] = bb[a * p + b];
            }
        }
        let y = &response[rows.clone()];
        Self { bb, by: base.iter().map(|b| dot(&b[rows.clone()], y)).collect(), yy: dot(y, y) }
    }

    fn add(&mut self, other: &Sums, times: f64) {
        self.bb.iter_mut().zip(&other.bb).for_each(|(a, b)| *a += times * b);
        self.by.iter_mut().zip(&other.by).for_each(|(a, b)| *a += times * b);
        self.yy += times * other.yy;
    }

    fn without(&self, part: &Sums) -> Self {
        let mut rest = self.clone();
        rest.add(part, -1.0);
        rest
    }

    fn factored(&self, penalty: &[f64]) -> Cholesky {
        let p = penalty.len();
        let mut matrix = self.bb.clone();
        penalty.iter().enumerate().for_each(|(a, penalty)| matrix[a * p + a] += penalty);
        Cholesky::new(&matrix, p, 0.0)
    }

    fn factors(&self, penalty: &[f64]) -> Vec<f64> {
        self.factored(penalty).solve(&self.by)
    }

    fn fold(&self, penalty: &[f64]) -> Fold {
        let factored = self.factored(penalty);
        Fold { factors: factored.solve(&self.by), inverse: factored.inverse() }
    }

    /// Squared error with these factors.
    fn loss(&self, factors: &[f64]) -> f64 {
        (self.yy - 2.0 * dot(factors, &self.by) + dot(factors, &times(&self.bb, factors))).max(0.0)
    }
}

/// Factors of columns for a response over all rows alone.
pub fn fitted(columns: &[BaseColumn], response: &[f64], weight: &[f64], ridge: f64) -> Vec<f64> {
    let weighted =
        |values: &[f64], by: f64| -> Vec<f64> { values.iter().zip(weight).map(|(v, w)| v * w / by).collect() };
    let scale = |c: &BaseColumn| c.scale.max(f64::MIN_POSITIVE);
    let base: Vec<Vec<f64>> = columns.iter().map(|c| weighted(c.values, scale(c))).collect();
    let n = response.len() as f64;
    let sums = Sums::of(&base, &weighted(response, 1.0), &(0..response.len()));
    let penalty: Vec<f64> = columns.iter().map(|c| if c.shrinks { ridge } else { FREE } * n).collect();
    sums.factors(&penalty).iter().zip(columns).map(|(f, c)| f / scale(c)).collect()
}

/// A symmetric matrix times a vector.
fn times(matrix: &[f64], vector: &[f64]) -> Vec<f64> {
    matrix.chunks(vector.len().max(1)).map(|row| dot(row, vector)).collect()
}

/// Columns beside a base, in sums of products: what they would add without each block, and what that block says then.
pub struct Added {
    pub size: usize,
    /// Products of what the columns have of their own with themselves and with the response.
    own: Vec<f64>,
    side: Vec<f64>,
    /// Share of the columns that is their own.
    pub visible: f64,
    /// The same without each block, and of that block alone.
    without: Vec<Normal>,
    held_out: Vec<Normal>,
    /// The same of each block beside the whole base.
    within: Vec<Normal>,
    diagonal: Vec<f64>,
}

impl Added {
    fn new(ground: &Ground, columns: &[Vec<f64>]) -> Self {
        let (k, p) = (columns.len(), ground.base.len());
        let sums: Vec<Products> = ground.blocks.iter().map(|rows| Products::of(ground, columns, rows)).collect();
        let mut all = Products::none(k, p);
        sums.iter().for_each(|s| all.add(s, 1.0));
        let solved =
            |fold: &Fold, of: &Products| -> Vec<Vec<f64>> { of.jb.iter().map(|jb| times(&fold.inverse, jb)).collect() };
        // In the whole: of what is left of the columns, with a base that is held near zero only in part.
        let along = solved(&ground.whole, &all);
        let (own, side) = all.projected(&along, &ground.whole.factors);
        let diagonal: Vec<f64> = (0..k).map(|a| all.jj[a * k + a]).collect();
        let visible = (0..k).map(|a| own[a * k + a] / diagonal[a].max(f64::MIN_POSITIVE)).fold(f64::INFINITY, f64::min);
        let mut out = Self {
            size: k,
            own,
            side,
            visible,
            without: Vec::with_capacity(sums.len()),
            held_out: Vec::with_capacity(sums.len()),
            within: Vec::with_capacity(sums.len()),
            diagonal,
        };
        for ((part, each), fold) in sums.iter().zip(&ground.each).zip(&ground.folds) {
            let rest = all.without(part);
            let of_fold = solved(fold, &rest);
            out.without.push(rest.projected(&of_fold, &fold.factors));
            out.held_out.push(part.left(each, &of_fold, &fold.factors));
            out.within.push(part.left(each, &along, &ground.whole.factors));
        }
        out
    }

    /// Factors in the whole run.
    pub fn factors(&self) -> Vec<f64> {
        Cholesky::new(&self.own, self.size, 1e-12).solve(&self.side)
    }

    /// Weighted squared error that the columns take off in the whole run.
    pub fn taken(&self) -> f64 {
        dot(&self.factors(), &self.side)
    }

    /// Squared size of what each column has of its own.
    pub fn squares(&self) -> impl Iterator<Item = f64> {
        (0..self.size).map(|a| self.own[a * self.size + a])
    }

    /// How sure the factors are not zero: the Wald statistic with the scatter of whole blocks under the alternative.
    pub fn wald(&self) -> f64 {
        let covariance = self.scatter(&self.factors());
        let white = Cholesky::new(&covariance, self.size, 1e-12).whiten(&self.side);
        dot(&white, &white)
    }

    /// Covariance of the products of the columns with what is left beside these factors of them.
    pub fn scatter(&self, factors: &[f64]) -> Vec<f64> {
        let k = self.size;
        let mut covariance = vec![0.0; k * k];
        for (own, side) in &self.within {
            let left: Vec<f64> = side.iter().zip(times(own, factors)).map(|(s, t)| s - t).collect();
            (0..k * k).for_each(|at| covariance[at] += left[at / k] * left[at % k]);
        }
        let groups = self.within.len() as f64;
        covariance.iter_mut().for_each(|c| *c *= groups / (groups - 1.0));
        covariance
    }

    /// What the columns take off each held-out block with factors that the others decide, and what they take off those.
    /// `ridge` holds the factors near zero; factors of which `allows` says no are zero.
    pub fn gains(&self, ridge: f64, allows: impl Fn(&[f64]) -> bool) -> Vec<Gain> {
        let k = self.size;
        let gain = |((own, side), (there, side_there)): (&Normal, &Normal)| {
            let mut own = own.clone();
            (0..k).for_each(|a| own[a * k + a] += (ridge + FREE) * self.diagonal[a]);
            let factors = Cholesky::new(&own, k, 1e-12).solve(side);
            if !allows(&factors) {
                return Gain { held_out: 0.0, fitted: 0.0 };
            }
            let held_out = 2.0 * dot(&factors, side_there) - dot(&factors, &times(there, &factors));
            Gain { held_out, fitted: dot(&factors, side) }
        };
        self.without.iter().zip(&self.held_out).map(gain).collect()
    }
}

/// What a candidate takes off one block, and off the rest that chose its factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    pub held_out: f64,
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

    fn of(ground: &Ground, columns: &[Vec<f64>], rows: &Range<usize>) -> Self {
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
        let with_base = |c: &Vec<f64>| ground.base.iter().map(|b| dot(c, &b[rows.clone()])).collect();
        Self {
            jj,
            jb: columns.iter().map(with_base).collect(),
            jy: columns.iter().map(|c| dot(c, &ground.response[rows.clone()])).collect(),
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

    /// What the columns have of their own beside a base with these factors for them and for the response.
    fn projected(&self, along: &[Vec<f64>], factors: &[f64]) -> Normal {
        let k = along.len();
        let own = (0..k * k).map(|at| self.jj[at] - dot(&self.jb[at / k], &along[at % k])).collect();
        let side = (0..k).map(|a| self.jy[a] - dot(&self.jb[a], factors)).collect();
        (own, side)
    }

    /// The same over rows that had no part in these factors.
    fn left(&self, base: &Sums, along: &[Vec<f64>], factors: &[f64]) -> Normal {
        let k = along.len();
        let inner: Vec<Vec<f64>> = along.iter().map(|a| times(&base.bb, a)).collect();
        let own = (0..k * k).map(|at| {
            let (a, b) = (at / k, at % k);
            self.jj[at] - dot(&along[a], &self.jb[b]) - dot(&self.jb[a], &along[b]) + dot(&inner[a], &along[b])
        });
        let side =
            (0..k).map(|a| self.jy[a] - dot(&along[a], &base.by) - dot(&self.jb[a], factors) + dot(&inner[a], factors));
        (own.collect(), side.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(frequency: f64) -> Vec<f64> {
        (0..240).map(|i| (frequency * f64::from(i)).sin()).collect()
    }

    #[test]
    fn a_gain_is_that_of_refits_without_each_block() {
        let (base, other, noise) = (column(0.3), column(0.7), column(2.9));
        let y: Vec<f64> = (0..240).map(|i| 2.0 * base[i] + 0.5 * other[i] + 0.3 * noise[i]).collect();
        let block: Vec<usize> = (0..240).map(|i| i / 30).collect();
        let free = |values| BaseColumn { values, scale: 1.0, shrinks: false };
        let weight = vec![1.0; 240];
        let alone = Ground::new(&[free(&base)], &y, &weight, &block, None);
        let both = Ground::new(&[free(&base), free(&other)], &y, &weight, &block, None);
        let single: Vec<f32> = other.iter().map(|v| *v as f32).collect();
        let added = alone.added(&[single]);
        for ((gain, was), is) in added.gains(0.0, |_| true).iter().zip(&alone.losses).zip(&both.losses) {
            assert!((was - gain.held_out - is).abs() < 1e-4 * was, "{was} {gain:?} {is}");
        }
        assert!((added.factors()[0] - both.factors()[1]).abs() < 1e-5);
        assert!(added.wald() > 100.0);
    }
}
