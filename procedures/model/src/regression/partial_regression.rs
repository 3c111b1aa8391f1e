//! What a model leaves, and what a candidate would take of it: sums of products over the run and over its stretches.
//! Nothing else is asked of a candidate's columns, so they are read and never copied.

use crate::linear::basis::{Basis, dot};
use crate::linear::cholesky::Cholesky;
use crate::preprocess::Problem;
use crate::regression::linear_model::LinearModel;
use crate::stats::permutation_test::Score;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use std::ops::Range;

/// A long run is turned over in groups of neighbouring blocks.
const MOST_GROUPS: usize = 400;

/// Where less than this share of a column is its own, the data cannot tell it from the model.
const LEAST_TOLERANCE: f64 = 1e-5;

/// A residual beside the basis that left it.
pub struct PartialRegression {
    pub basis: Basis,
    pub residual: Vec<f64>,
    /// Squared residual.
    pub energy: f64,
    /// Rows that are turned over together.
    groups: Vec<Range<usize>>,
    /// Products of each vector of the basis with the residual, group by group.
    shared: Vec<Vec<f64>>,
}

/// What the columns of a candidate are beside a basis (the added-variable step).
pub struct Orthogonalized {
    /// Share of the squared residual that they explain.
    pub share: f64,
    /// Share of the squared columns that is their own: the rest looks like the model.
    pub visible: f64,
    /// Columns that have something of their own.
    kept: Vec<usize>,
    /// Products with the vectors of the basis, column by column.
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
        Self { energy: dot(&residual, &residual), basis, residual, groups, shared }
    }

    pub fn own<C: Into<f64> + Copy>(&self, columns: &[Vec<C>]) -> Orthogonalized {
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
        let share = if self.energy > 0.0 { explained / self.energy } else { 0.0 };
        let visible = (0..p).map(|a| gram[a * p + a]).sum::<f64>() / sum;
        Orthogonalized { share, visible, kept, along, gram, side }
    }

    /// Products of what each kept column has of its own with the residual, group by group.
    pub fn sums<C: Into<f64> + Copy>(&self, columns: &[Vec<C>], own: &Orthogonalized) -> Vec<Vec<f64>> {
        let of = |a: &usize| {
            let mut sums = products(&columns[*a], &self.residual, &self.groups);
            for (shared, along) in self.shared.iter().zip(&own.along[*a]) {
                sums.iter_mut().zip(shared).for_each(|(s, q)| *s -= along * q);
            }
            sums
        };
        own.kept.iter().map(of).collect()
    }

    /// The factor of a single column in standard errors of a jackknife over the groups, on the scale of a standard normal:
    /// Student's t at the number of equal groups that would decide it as well as these do. `None` for several columns.
    ///
    /// A score's own scatter holds the effect itself. One that only few stretches can show would never get past it,
    /// however clearly they do.
    pub fn jackknife_z(&self, columns: &[Vec<f64>]) -> Option<f64> {
        let [column] = columns else { return None };
        let rest = self.basis.rest(column);
        let sums = products(&rest, &self.residual, &self.groups);
        let squares = products(&rest, &rest, &self.groups);
        let chance = jackknife(&sums, &squares)?;
        Some(Normal::standard().inverse_cdf(1.0 - chance.max(1e-15))).filter(|z| z.is_finite())
    }

    /// How many equal groups would decide the factors of these columns as well as these do.
    pub fn deciding(&self, columns: &[Vec<f32>]) -> Option<f64> {
        let squares = |column: &Vec<f32>| {
            let rest = self.basis.rest(&column.iter().copied().map(f64::from).collect::<Vec<_>>());
            products(&rest, &rest, &self.groups)
        };
        let of = |squares: Vec<f64>| squares.iter().sum::<f64>().powi(2) / dot(&squares, &squares);
        columns.iter().map(squares).map(of).reduce(f64::min).filter(|groups| *groups > 1.0)
    }

    pub fn score<C: Into<f64> + Copy>(&self, columns: &[Vec<C>], own: &Orthogonalized) -> Score {
        Score::new(&self.sums(columns, own))
    }
}

impl Orthogonalized {
    /// Factors of the columns beside the basis.
    pub fn factors(&self) -> Vec<f64> {
        Cholesky::new(&self.gram, self.side.len(), 0.0).solve(&self.side)
    }

    /// Squares of what each kept column has of its own.
    pub fn squares(&self) -> impl Iterator<Item = f64> {
        self.kept.iter().map(|a| self.gram[a * self.side.len() + a])
    }
}

/// How often noise alone would bring a factor so far from zero, beside the scatter of groups: `sums` are the products of its
/// column with the residual, `squares` those with itself.
pub fn jackknife(sums: &[f64], squares: &[f64]) -> Option<f64> {
    let (sum, square) = (sums.iter().sum::<f64>(), squares.iter().sum::<f64>());
    let factor = sum / square;
    let without = |(s, h): (&f64, &f64)| ((sum - s) / (square - h) - factor).powi(2);
    let n = sums.len() as f64;
    let error = ((n - 1.0) / n * sums.iter().zip(squares).map(without).sum::<f64>()).sqrt();
    let deciding = square * square / dot(squares, squares);
    let t = StudentsT::new(0.0, 1.0, deciding - 1.0).ok()?;
    Some(2.0 * t.sf((factor / error).abs()))
}

pub fn products<C: Into<f64> + Copy>(a: &[C], b: &[f64], groups: &[Range<usize>]) -> Vec<f64> {
    groups.iter().map(|rows| dot(&a[rows.clone()], &b[rows.clone()])).collect()
}
