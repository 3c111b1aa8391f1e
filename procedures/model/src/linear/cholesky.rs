//! Cholesky factors of scaled, symmetric positive definite systems.

use crate::linear::basis::dot;

/// Longer rows are multiplied with whole registers.
const LONG: usize = 32;

/// Symmetric positive definite system, factorized on scaled columns. A dependent column gets the coefficient zero.
#[derive(Debug, Clone)]
pub struct Cholesky {
    n: usize,
    /// Lower triangle, row by row.
    l: Vec<f64>,
    scale: Vec<f64>,
    dead: Vec<bool>,
}

impl Cholesky {
    /// Cholesky of a row-major matrix after scaling its diagonal to one. `ridge` is added to the scaled diagonal.
    pub fn new(matrix: &[f64], n: usize, ridge: f64) -> Self {
        Self::with_min_pivot(matrix, n, ridge, &vec![0.0; n])
    }

    /// The same, where a column also gets zero if its squared orthogonal part (given the columns before it) is less
    /// than `least`.
    pub fn with_min_pivot(matrix: &[f64], n: usize, ridge: f64, least: &[f64]) -> Self {
        let scale: Vec<f64> =
            (0..n).map(|i| if matrix[i * n + i] > 0.0 { matrix[i * n + i].sqrt().recip() } else { 0.0 }).collect();
        let mut l = vec![0.0; n * n];
        let mut dead = vec![false; n];
        for i in 0..n {
            for j in 0..=i {
                let mut sum = matrix[i * n + j] * scale[i] * scale[j];
                if i == j {
                    sum += ridge;
                }
                if j < LONG {
                    for k in 0..j {
                        sum -= l[i * n + k] * l[j * n + k];
                    }
                } else {
                    sum -= dot(&l[i * n..i * n + j], &l[j * n..j * n + j]);
                }
                if i == j {
                    if sum > (least[i] * scale[i].powi(2)).max(1e-10) {
                        l[i * n + i] = sum.sqrt();
                    } else {
                        dead[i] = true;
                    }
                } else if !dead[j] {
                    l[i * n + j] = sum / l[j * n + j];
                }
            }
            if dead[i] {
                (0..=i).for_each(|j| l[i * n + j] = 0.0);
            }
        }
        Self { n, l, scale, dead }
    }

    /// The inverse of the matrix, row by row, with zeros for dependent columns.
    pub fn inverse(&self) -> Vec<f64> {
        let n = self.n;
        // Rows of the inverse of L.
        let mut lower = vec![0.0; n * n];
        for i in (0..n).filter(|i| !self.dead[*i]) {
            let mut row = vec![0.0; i + 1];
            for k in (0..i).filter(|k| !self.dead[*k]) {
                let entry = self.l[i * n + k];
                row.iter_mut().zip(&lower[k * n..=k * n + k]).for_each(|(r, l)| *r -= entry * l);
            }
            row[i] += 1.0;
            row.iter().enumerate().for_each(|(j, r)| lower[i * n + j] = r / self.l[i * n + i]);
        }
        let mut inverse = vec![0.0; n * n];
        for k in 0..n {
            for i in 0..=k {
                let entry = lower[k * n + i];
                let row = &lower[k * n..=k * n + k];
                inverse[i * n..=i * n + k].iter_mut().zip(row).for_each(|(sum, l)| *sum += entry * l);
            }
        }
        (0..n * n).for_each(|at| inverse[at] *= self.scale[at / n] * self.scale[at % n]);
        inverse
    }

    /// Whether column `i` depends linearly on the columns before it, so that its coefficient is zero.
    pub fn is_dependent(&self, i: usize) -> bool {
        self.dead[i]
    }

    /// Squared orthogonal part of each column, given the columns before it.
    pub fn orthogonal_squares(&self) -> impl Iterator<Item = f64> {
        let square = |i: usize| if self.dead[i] { 0.0 } else { (self.l[i * self.n + i] / self.scale[i]).powi(2) };
        (0..self.n).map(square)
    }

    /// L⁻¹·D·b, whose squared norm is bᵀA⁻¹b.
    pub fn whiten(&self, b: &[f64]) -> Vec<f64> {
        let n = self.n;
        let mut x = vec![0.0; n];
        for i in 0..n {
            if self.dead[i] {
                continue;
            }
            let below: f64 = (0..i).map(|k| self.l[i * n + k] * x[k]).sum();
            x[i] = (b[i] * self.scale[i] - below) / self.l[i * n + i];
        }
        x
    }

    /// Solution of A·x = b, with zeros for dependent columns.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let n = self.n;
        let mut x = self.whiten(b);
        for i in (0..n).rev() {
            if self.dead[i] {
                x[i] = 0.0;
                continue;
            }
            let above: f64 = (i + 1..n).map(|k| self.l[k * n + i] * x[k]).sum();
            x[i] = (x[i] - above) / self.l[i * n + i];
        }
        x.iter_mut().zip(&self.scale).for_each(|(x, s)| *x *= s);
        x
    }
}

/// Least-squares coefficients of each column in others, with zeros for dependent ones.
pub fn projections(columns: &[Vec<f64>], on: &[&Vec<f64>]) -> Vec<Vec<f64>> {
    let size = on.len();
    let gram: Vec<f64> = on.iter().flat_map(|a| on.iter().map(move |b| dot(a, b))).collect();
    let gram = Cholesky::new(&gram, size, 0.0);
    let of = |column: &Vec<f64>| gram.solve(&on.iter().map(|own| dot(own, column)).collect::<Vec<f64>>());
    columns.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inverse_solves_as_the_cholesky_factor_does() {
        let n = 40;
        let column = |a: usize| -> Vec<f64> {
            (0..90).map(|i| ((a * 37 + i * 13) as f64 * 0.7).sin() + 0.1 * a as f64).collect()
        };
        let columns: Vec<Vec<f64>> = (0..n).map(column).collect();
        let gram: Vec<f64> = (0..n * n)
            .map(|at| dot(&columns[at / n], &columns[at % n]) + if at / n == at % n { 1.0 } else { 0.0 })
            .collect();
        let side: Vec<f64> = (0..n).map(|a| (a as f64).cos()).collect();
        let factorized = Cholesky::new(&gram, n, 0.0);
        let (solved, inverse) = (factorized.solve(&side), factorized.inverse());
        for (row, x) in inverse.chunks(n).zip(solved) {
            assert!((dot(row, &side) - x).abs() < 1e-9 * x.abs().max(1.0));
        }
    }
}
