//! An orthonormal basis of columns, grown one column at a time.

use multiversion::multiversion;

/// Orthonormal vectors of equal length.
#[derive(Debug, Clone, Default)]
pub struct Basis {
    vectors: Vec<Vec<f64>>,
}

/// A column is taken as dependent on the others where less than this share of its square is left.
const DEPENDENT: f64 = 1e-10;

/// Where more than this share of a column's square is left, rounding has left nothing of the others in it.
const CLEAN: f64 = 0.5;

/// Σ ab, in double precision whatever the numbers are kept in.
#[multiversion(targets("x86_64+avx512f+avx512dq", "x86_64+avx2"))]
pub fn dot<A: Into<f64> + Copy, B: Into<f64> + Copy>(a: &[A], b: &[B]) -> f64 {
    // Eight sums that do not wait for each other let the compiler use whole registers.
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

    /// Adds what is new in a column. Returns the share of its square that is new; nothing is added where that is none.
    pub fn push(&mut self, column: &[f64]) -> f64 {
        let before = dot(column, column);
        if before == 0.0 {
            return 0.0;
        }
        let mut rest = column.to_vec();
        self.project_out(&mut rest);
        let mut after = dot(&rest, &rest);
        // Twice is enough (Kahan, Parlett): the second pass removes what rounding left in the first, where that took most.
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

    /// Removes from a column what the basis explains.
    pub fn project_out(&self, column: &mut [f64]) {
        for q in &self.vectors {
            let share = dot(q, column);
            column.iter_mut().zip(q).for_each(|(c, q)| *c -= share * q);
        }
    }

    /// The column without what the basis explains.
    pub fn rest(&self, column: &[f64]) -> Vec<f64> {
        let mut rest = column.to_vec();
        self.project_out(&mut rest);
        rest
    }
}
