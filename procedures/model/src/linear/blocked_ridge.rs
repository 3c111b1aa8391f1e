//! Ridge regression of a response on a base of columns, over the whole run and without each of its blocks in turn.
//!
//! The rows are read once; all results follow from sums of products over blocks.

use crate::linear::basis::dot;
use crate::linear::cholesky::Cholesky;
use rayon::prelude::*;
use std::ops::Range;

/// Tested ridge strengths, as shares of the rows.
const RIDGES: [f64; 7] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0];
/// Small penalty that keeps the other columns solvable.
pub(in crate::linear) const FREE: f64 = 1e-9;

/// A column of the base.
#[derive(Clone, Copy)]
pub struct BaseColumn<'a> {
    pub values: &'a [f64],
    /// Scale of the ridge penalty.
    pub scale: f64,
    pub is_penalised: bool,
}

/// Sums of products over some rows: of the base with itself and with the response, and of the response.
#[derive(Clone)]
pub(in crate::linear) struct Sums {
    pub bb: Vec<f64>,
    pub by: Vec<f64>,
    yy: f64,
}

/// The base without one block.
pub(in crate::linear) struct Fold {
    /// Inverse of the Gram matrix of the base, because each base is solved for hundreds of columns.
    pub inverse: Vec<f64>,
    /// Coefficients of the base for the response.
    pub coefficients: Vec<f64>,
}

/// Ridge regression of a response on a base of columns, solved without each block in turn.
pub struct BlockedRidge {
    /// Rows of each block.
    pub blocks: Vec<Range<usize>>,
    pub(in crate::linear) weight: Vec<f64>,
    pub(in crate::linear) base: Vec<Vec<f64>>,
    scale: Vec<f64>,
    pub(in crate::linear) response: Vec<f64>,
    /// Penalty of each column as a share of the rows.
    held: Vec<f64>,
    pub(in crate::linear) each: Vec<Sums>,
    pub(in crate::linear) folds: Vec<Fold>,
    pub(in crate::linear) whole: Fold,
    /// Ridge strength as a share of the rows.
    pub strength: f64,
    /// Weighted squared validation error of each block.
    pub losses: Vec<f64>,
}

/// Regression of a response on a base of columns over some of its rows.
pub struct Outside {
    rows: Vec<usize>,
    base: Vec<Vec<f64>>,
    weight: Vec<f64>,
    inverse: Vec<f64>,
    left: Vec<f64>,
}

impl Outside {
    /// Weighted squared error of the base.
    pub fn left(&self) -> f64 {
        dot(&self.left, &self.left)
    }

    /// Coefficients of columns added to the base, and the weighted squared error that they explain. `None` if the
    /// tolerance of a column is below `visible`.
    pub fn added(&self, columns: &[impl AsRef<[f32]>], visible: f64) -> Option<(Vec<f64>, f64)> {
        let weighted = |c: &[f32]| self.rows.iter().zip(&self.weight).map(|(row, w)| f64::from(c[*row]) * w).collect();
        let rest = |column: Vec<f64>| {
            let mut own = column.clone();
            let side: Vec<f64> = self.base.iter().map(|b| dot(b, &own)).collect();
            for (base, coefficient) in self.base.iter().zip(times(&self.inverse, &side)) {
                own.iter_mut().zip(base).for_each(|(o, b)| *o -= coefficient * b);
            }
            (dot(&own, &own) > visible * dot(&column, &column)).then_some(own)
        };
        let own: Vec<Vec<f64>> = columns.iter().map(|c| rest(weighted(c.as_ref()))).collect::<Option<_>>()?;
        let k = own.len();
        let products: Vec<f64> = (0..k * k).map(|at| dot(&own[at / k], &own[at % k])).collect();
        let side: Vec<f64> = own.iter().map(|own| dot(own, &self.left)).collect();
        let coefficients = Cholesky::new(&products, k, 1e-12).solve(&side);
        let taken = dot(&coefficients, &side);
        Some((coefficients, taken))
    }
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

impl BlockedRidge {
    /// `strength`: the ridge strength, or the one of [`RIDGES`] with the smallest validation error.
    pub fn new(
        columns: &[BaseColumn],
        response: &[f64],
        weight: &[f64],
        block: &[usize],
        strength: Option<f64>,
    ) -> Self {
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
        let penalty = |strength: f64| -> Vec<f64> {
            columns.iter().map(|c| if c.is_penalised { strength } else { FREE } * n).collect()
        };
        let is_penalised = columns.iter().any(|c| c.is_penalised);
        let loss = |strength: f64| -> f64 {
            let penalty = penalty(strength);
            each.par_iter().map(|sums| sums.loss(&all.without(sums).coefficients(&penalty))).sum()
        };
        let strength = strength.unwrap_or_else(|| {
            let tried = RIDGES.iter().filter(|_| is_penalised).map(|strength| (*strength, loss(*strength)));
            tried.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(1.0, |best| best.0)
        });
        let penalty = penalty(strength);
        let folds: Vec<Fold> = each.par_iter().map(|sums| all.without(sums).fold(&penalty)).collect();
        let losses = each.iter().zip(&folds).map(|(sums, fold)| sums.loss(&fold.coefficients)).collect();
        let whole = all.fold(&penalty);
        let held = penalty.iter().map(|penalty| penalty / n).collect();
        Self { blocks, weight: weight.to_vec(), base, scale, response, held, each, folds, whole, strength, losses }
    }

    pub fn loss(&self) -> f64 {
        self.losses.iter().sum()
    }

    /// Coefficients of the original columns, over all rows.
    pub fn coefficients(&self) -> Vec<f64> {
        self.whole.coefficients.iter().zip(&self.scale).map(|(f, s)| f / s).collect()
    }

    /// Coefficients without each block in turn.
    pub fn replicates(&self) -> impl Iterator<Item = Vec<f64>> {
        self.folds.iter().map(|fold| fold.coefficients.iter().zip(&self.scale).map(|(f, s)| f / s).collect())
    }

    /// The same base on only the rows that are not `near` a reversal. `None` if there are fewer of them than columns.
    pub fn outside(&self, near: &[bool]) -> Option<Outside> {
        let rows: Vec<usize> = (0..self.response.len()).filter(|row| near.get(*row) == Some(&false)).collect();
        if rows.len() <= self.base.len() {
            return None;
        }
        let of = |values: &[f64]| -> Vec<f64> { rows.iter().map(|row| values[*row]).collect() };
        let base: Vec<Vec<f64>> = self.base.iter().map(|values| of(values)).collect();
        let (weight, mut left) = (of(&self.weight), of(&self.response));
        let sums = Sums::of(&base, &left, &(0..rows.len()));
        let penalty: Vec<f64> = self.held.iter().map(|share| share * rows.len() as f64).collect();
        let fold = sums.fold(&penalty);
        for (base, coefficient) in base.iter().zip(&fold.coefficients) {
            left.iter_mut().zip(base).for_each(|(e, b)| *e -= coefficient * b);
        }
        Some(Outside { rows, base, weight, inverse: fold.inverse, left })
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

    fn factorized(&self, penalty: &[f64]) -> Cholesky {
        let p = penalty.len();
        let mut matrix = self.bb.clone();
        penalty.iter().enumerate().for_each(|(a, penalty)| matrix[a * p + a] += penalty);
        Cholesky::new(&matrix, p, 0.0)
    }

    fn coefficients(&self, penalty: &[f64]) -> Vec<f64> {
        self.factorized(penalty).solve(&self.by)
    }

    fn fold(&self, penalty: &[f64]) -> Fold {
        let factorized = self.factorized(penalty);
        Fold { coefficients: factorized.solve(&self.by), inverse: factorized.inverse() }
    }

    /// Squared error with these coefficients.
    fn loss(&self, coefficients: &[f64]) -> f64 {
        (self.yy - 2.0 * dot(coefficients, &self.by) + dot(coefficients, &times(&self.bb, coefficients))).max(0.0)
    }
}

/// Ridge coefficients of columns for a response, over all rows only.
pub fn fitted(columns: &[BaseColumn], response: &[f64], weight: &[f64], strength: f64) -> Vec<f64> {
    let weighted =
        |values: &[f64], by: f64| -> Vec<f64> { values.iter().zip(weight).map(|(v, w)| v * w / by).collect() };
    let scale = |c: &BaseColumn| c.scale.max(f64::MIN_POSITIVE);
    let base: Vec<Vec<f64>> = columns.iter().map(|c| weighted(c.values, scale(c))).collect();
    let n = response.len() as f64;
    let sums = Sums::of(&base, &weighted(response, 1.0), &(0..response.len()));
    let penalty: Vec<f64> = columns.iter().map(|c| if c.is_penalised { strength } else { FREE } * n).collect();
    sums.coefficients(&penalty).iter().zip(columns).map(|(f, c)| f / scale(c)).collect()
}

/// A symmetric matrix times a vector.
pub(in crate::linear) fn times(matrix: &[f64], vector: &[f64]) -> Vec<f64> {
    matrix.chunks(vector.len().max(1)).map(|row| dot(row, vector)).collect()
}
