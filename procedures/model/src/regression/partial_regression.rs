//! Partial regression of a candidate on the residual of a model (added-variable step), from sums of products over the
//! run and over its blocks. Only products of a candidate's columns are needed, so that the columns are never copied.

use crate::linear::basis::{Basis, dot};
use crate::linear::cholesky::Cholesky;
use crate::preprocess::Problem;
use crate::regression::linear_model::LinearModel;
use crate::stats::permutation_test::Score;
use crate::stats::{jackknife, student};
use statrs::distribution::{ContinuousCDF, Normal};
use std::ops::Range;

/// A long run flips the signs of groups of neighbouring blocks together.
const MOST_GROUPS: usize = 400;

/// A column with a smaller tolerance (1 − R² on the model) is collinear with the model.
pub const LEAST_TOLERANCE: f64 = 1e-5;

/// The residual of a model with the orthonormal basis of its tangent space.
pub struct PartialRegression {
    pub basis: Basis,
    pub residual: Vec<f64>,
    /// Squared residual.
    pub sse: f64,
    /// Rows whose signs are flipped together.
    groups: Vec<Range<usize>>,
    /// Products of each basis vector with the residual, for each group.
    shared: Vec<Vec<f64>>,
}

/// Columns of a candidate, orthogonalized against a basis (the added-variable step).
pub struct Orthogonalized {
    /// Partial R²: share of the squared residual that the columns explain.
    pub share: f64,
    /// Tolerance: share of the squared columns that is orthogonal to the model.
    pub visible: f64,
    /// Columns that are not collinear with the model.
    kept: Vec<usize>,
    /// Products with the basis vectors, column by column.
    along: Vec<Vec<f64>>,
    gram: Vec<f64>,
    side: Vec<f64>,
}

impl PartialRegression {
    pub fn of(terms: &LinearModel) -> Self {
        let basis = terms.tangent();
        let residual = basis.rest(&terms.response());
        Self::new(basis, residual, terms.problem)
    }

    pub fn new(basis: Basis, residual: Vec<f64>, problem: &Problem) -> Self {
        let most = problem.blocks.min(MOST_GROUPS);
        let group = |block: usize| block * most / problem.blocks.max(1);
        let mut end = 0;
        let groups: Vec<Range<usize>> = problem
            .block
            .chunk_by(|a, b| group(*a) == group(*b))
            .map(|rows| {
                end += rows.len();
                end - rows.len()..end
            })
            .collect();
        let shared = basis.vectors().iter().map(|q| products(q, &residual, &groups)).collect();
        Self { sse: dot(&residual, &residual), basis, residual, groups, shared }
    }

    pub fn orthogonalized<C: Into<f64> + Copy>(&self, columns: &[Vec<C>]) -> Orthogonalized {
        let p = columns.len();
        let along: Vec<Vec<f64>> =
            columns.iter().map(|c| self.basis.vectors().iter().map(|q| dot(q, c)).collect()).collect();
        let mut gram = vec![0.0; p * p];
        let (mut largest, mut sum) = (0.0f64, 0.0);
        for a in 0..p {
            for b in 0..=a {
                let whole = dot(&columns[a], &columns[b]);
                if a == b {
                    largest = largest.max(whole);
                    sum += whole;
                }
                gram[a * p + b] = whole - dot(&along[a], &along[b]);
                gram[b * p + a] = gram[a * p + b];
            }
        }
        let side: Vec<f64> = columns.iter().map(|c| dot(c, &self.residual)).collect();
        let kept: Vec<usize> = (0..p).filter(|a| gram[a * p + a] > LEAST_TOLERANCE * largest).collect();
        let entry = |at: usize| gram[kept[at / kept.len()] * p + kept[at % kept.len()]];
        let of_kept: Vec<f64> = (0..kept.len().pow(2)).map(entry).collect();
        let side_of_kept: Vec<f64> = kept.iter().map(|a| side[*a]).collect();
        let explained: f64 = Cholesky::new(&of_kept, kept.len(), 0.0).whiten(&side_of_kept).iter().map(|v| v * v).sum();
        let share = if self.sse > 0.0 { explained / self.sse } else { 0.0 };
        let visible = (0..p).map(|a| gram[a * p + a]).sum::<f64>() / sum;
        Orthogonalized { share, visible, kept, along, gram, side }
    }

    /// Products of the orthogonal part of each kept column with the residual, for each group.
    pub fn sums<C: Into<f64> + Copy>(&self, columns: &[Vec<C>], orthogonalized: &Orthogonalized) -> Vec<Vec<f64>> {
        let of = |a: &usize| {
            let mut sums = products(&columns[*a], &self.residual, &self.groups);
            for (shared, along) in self.shared.iter().zip(&orthogonalized.along[*a]) {
                sums.iter_mut().zip(shared).for_each(|(s, q)| *s -= along * q);
            }
            sums
        };
        orthogonalized.kept.iter().map(of).collect()
    }

    /// The coefficient of a single column in jackknife standard errors over the groups, converted to a standard
    /// normal scale. Its Student's t has the degrees of freedom of the equivalent number of equal groups. `None` for
    /// several columns.
    ///
    /// The scatter in a score includes the effect itself, so that an effect that only few blocks can show never
    /// becomes significant by its score.
    pub fn jackknife_z(&self, columns: &[Vec<f64>]) -> Option<f64> {
        let [column] = columns else { return None };
        let rest = self.basis.rest(column);
        let sums = products(&rest, &self.residual, &self.groups);
        let squares = products(&rest, &rest, &self.groups);
        let chance = jackknife_p_value(&sums, &squares)?;
        Some(Normal::standard().inverse_cdf(1.0 - chance.max(1e-15))).filter(|z| z.is_finite())
    }

    /// Equivalent number of equal groups that determine the coefficients of these columns as well.
    pub fn deciding(&self, columns: &[Vec<f32>]) -> Option<f64> {
        let squares = |column: &Vec<f32>| {
            let rest = self.basis.rest(&column.iter().copied().map(f64::from).collect::<Vec<_>>());
            products(&rest, &rest, &self.groups)
        };
        let of = |squares: Vec<f64>| squares.iter().sum::<f64>().powi(2) / dot(&squares, &squares);
        columns.iter().map(squares).map(of).reduce(f64::min).filter(|groups| *groups > 1.0)
    }

    pub fn score<C: Into<f64> + Copy>(&self, columns: &[Vec<C>], orthogonalized: &Orthogonalized) -> Score {
        Score::new(&self.sums(columns, orthogonalized))
    }
}

impl Orthogonalized {
    /// Coefficients of the columns, given the basis.
    pub fn coefficients(&self) -> Vec<f64> {
        Cholesky::new(&self.gram, self.side.len(), 0.0).solve(&self.side)
    }

    /// Squares of the orthogonal part of each kept column.
    pub fn squares(&self) -> impl Iterator<Item = f64> {
        self.kept.iter().map(|a| self.gram[a * self.side.len() + a])
    }
}

/// p-value of a coefficient by a jackknife over groups: `sums` are the products of its column with the residual,
/// `squares` those with itself.
pub fn jackknife_p_value(sums: &[f64], squares: &[f64]) -> Option<f64> {
    let (sum, square) = (sums.iter().sum::<f64>(), squares.iter().sum::<f64>());
    let coefficient = sum / square;
    let without = |(s, h): (&f64, &f64)| ((sum - s) / (square - h) - coefficient).powi(2);
    let error = jackknife::variance(sums.iter().zip(squares).map(without), sums.len() as f64).sqrt();
    let deciding = square * square / dot(squares, squares);
    student::p_value(deciding - 1.0, (coefficient / error).abs())
}

pub fn products<C: Into<f64> + Copy>(a: &[C], b: &[f64], groups: &[Range<usize>]) -> Vec<f64> {
    groups.iter().map(|rows| dot(&a[rows.clone()], &b[rows.clone()])).collect()
}
