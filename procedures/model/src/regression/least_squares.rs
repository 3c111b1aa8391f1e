//! Coefficients of a model, and its tangent space.

use crate::linear::basis::{Basis, dot};
use crate::linear::cholesky::Cholesky;
use crate::regression::linear_model::{Linear, LinearModel, slopes};
use crate::regression::solution::Solution;

impl LinearModel<'_> {
    /// The solution: ridge regression with form-error columns if the run is judged sample by sample, otherwise least
    /// squares.
    pub fn linear(&self) -> Linear {
        if let Some(solution) = Solution::of(self) {
            return solution.linear(self);
        }
        let columns = self.columns();
        let response = self.response();
        let basis = Basis::of(self.terms.iter().flat_map(|t| &t.columns));
        let residual = basis.rest(&response);
        let p = columns.len();
        let mut gram = vec![0.0; p * p];
        for a in 0..p {
            for b in 0..=a {
                gram[a * p + b] = dot(columns[a], columns[b]);
                gram[b * p + a] = gram[a * p + b];
            }
        }
        let explained: Vec<f64> = response.iter().zip(&residual).map(|(y, e)| y - e).collect();
        let side: Vec<f64> = columns.iter().map(|c| dot(c, &explained)).collect();
        let flat = Cholesky::new(&gram, p, 0.0).solve(&side);
        let mut next = flat.into_iter();
        let coefficients = self.terms.iter().map(|t| next.by_ref().take(t.columns.len()).collect()).collect();
        let sse = dot(&residual, &residual);
        Linear { coefficients, residual, sse }
    }

    /// Tangent space: the columns of the model and its derivatives in the nonlinear parameters. A new effect has to
    /// explain more than a shift of these parameters does.
    pub fn tangent(&self) -> Basis {
        let mut basis = Basis::of(self.terms.iter().flat_map(|t| &t.columns));
        if self.terms.iter().all(|t| t.free().next().is_none()) {
            return basis;
        }
        let linear = self.linear();
        for (term, coefficients) in self.terms.iter().zip(&linear.coefficients) {
            for slope in slopes(term, coefficients, self.problem) {
                basis.push(&slope);
            }
        }
        basis
    }
}
