//! An orthonormal basis of columns, grown one column at a time.

use multiversion::multiversion;

/// Orthonormal vectors of equal length.
#[derive(Debug, Clone, Default)]
pub struct Basis {
    vectors: Vec<Vec<f64>>,
}

/// A column with a smaller remaining share of its square counts as linearly dependent.
const DEPENDENT: f64 = 1e-10;

/// With a larger remaining share, rounding errors are negligible and one pass is sufficient.
const CLEAN: f64 = 0.5;

/// Σ ab in double precision, for inputs of either precision.
#[multiversion(targets("x86_64+avx512f+avx512dq", "x86_64+avx2"))]
pub fn dot<A: Into<f64> + Copy, B: Into<f64> + Copy>(a: &[A], b: &[B]) -> f64 {
    // Eight independent sums let the compiler use whole registers.
    let mut sums = [0.0; 8];
    let (a8, b8) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a8.remainder().iter().zip(b8.remainder()).map(|(x, y)| (*x).into() * (*y).into()).sum();
    for (x, y) in a8.zip(b8) {
        for i in 0..8 {
            sums[i] += x[i].into() * y[i].into();
        }
    }
    sums.iter().sum::<f64>() + rest
}

impl Basis {
    pub fn of<'a>(columns: impl IntoIterator<Item = &'a Vec<f64>>) -> Self {
        let mut basis = Self::default();
        columns.into_iter().for_each(|c| {
            basis.push(c);
        });
        basis
    }

    pub fn vectors(&self) -> &[Vec<f64>] {
        &self.vectors
    }

    /// Adds the orthogonal part of a column. Returns its share of the column's square; a dependent column is not
    /// added.
    pub fn push(&mut self, column: &[f64]) -> f64 {
        let before = dot(column, column);
        if before == 0.0 {
            return 0.0;
        }
        let mut rest = column.to_vec();
        self.project_out(&mut rest);
        let mut after = dot(&rest, &rest);
        // Twice is enough (Kahan, Parlett): the second pass removes the rounding errors of the first, if that removed
        // most of the column.
        if after < CLEAN * before {
            self.project_out(&mut rest);
            after = dot(&rest, &rest);
        }
        let share = after / before;
        if share > DEPENDENT {
            let scale = 1.0 / after.sqrt();
            rest.iter_mut().for_each(|v| *v *= scale);
            self.vectors.push(rest);
        }
        share
    }

    /// Removes from a column the part that the basis explains.
    pub fn project_out(&self, column: &mut [f64]) {
        for q in &self.vectors {
            let share = dot(q, column);
            column.iter_mut().zip(q).for_each(|(c, q)| *c -= share * q);
        }
    }

    /// The column without the part that the basis explains.
    pub fn rest(&self, column: &[f64]) -> Vec<f64> {
        let mut rest = column.to_vec();
        self.project_out(&mut rest);
        rest
    }
}
