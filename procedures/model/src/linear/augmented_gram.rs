//! Gram matrices of a model with each of several candidates added.

use crate::linear::basis::dot;
use crate::linear::gram::BlockGrams;
use rayon::prelude::*;
use std::ops::Range;

/// Sums of products over each group of rows. Products between different candidates are not computed.
pub struct AugmentedGrams {
    /// For each group the lower triangle of Σ xxᵀ, row-major, of all columns and the response.
    sums: Vec<Vec<f64>>,
    /// Number of columns of the model; the response follows them.
    model: usize,
    all: usize,
    /// Columns of each candidate.
    others: Vec<Range<usize>>,
    rows: Vec<usize>,
}

impl AugmentedGrams {
    /// One pass over the rows.
    pub fn new<'c>(
        model: &[&'c [f64]],
        others: impl IntoIterator<Item = &'c [Vec<f64>]>,
        y: &'c [f64],
        group: &[usize],
        groups: usize,
    ) -> Self {
        let mut columns: Vec<&[f64]> = model.iter().copied().chain([y]).collect();
        // The first column that is multiplied with each column, in addition to those of the model.
        let mut first = vec![0; columns.len()];
        let mut places = Vec::new();
        for other in others {
            let start = columns.len();
            columns.extend(other.iter().map(Vec::as_slice));
            first.resize(columns.len(), start);
            places.push(start..columns.len());
        }
        let (model, all) = (model.len(), columns.len());
        let mut stretches = vec![Vec::new(); groups];
        let mut end = 0;
        for rows in group.chunk_by(|a, b| a == b) {
            stretches[rows[0]].push(end..end + rows.len());
            end += rows.len();
        }
        let of_group = |stretches: &Vec<Range<usize>>| {
            let mut sums = vec![0.0; all * all];
            stretches.iter().for_each(|rows| {
                add_products(&columns, |a, b| b <= model || b >= first[a], rows.clone(), &mut sums);
            });
            sums
        };
        Self {
            sums: stretches.par_iter().map(of_group).collect(),
            model,
            all,
            others: places,
            rows: stretches.iter().map(|stretches| stretches.iter().map(Range::len).sum()).collect(),
        }
    }

    /// Gram matrices of the model with one of the candidates.
    pub fn grams(&self, other: usize) -> BlockGrams {
        let columns: Vec<usize> = (0..self.model).chain(self.others[other].clone()).collect();
        let product = |sums: &[f64], a: usize, b: usize| sums[a.max(b) * self.all + a.min(b)];
        let mut grams = BlockGrams::empty(columns.len(), self.rows.clone());
        for sums in &self.sums {
            for a in &columns {
                grams.xx.extend(columns.iter().map(|b| product(sums, *a, *b)));
                grams.xy.push(product(sums, *a, self.model));
            }
            grams.yy.push(product(sums, self.model, self.model));
        }
        grams
    }
}

impl BlockGrams {
    /// One pass over the rows.
    pub fn new(columns: &[&[f64]], y: &[f64], group: &[usize], groups: usize) -> Self {
        AugmentedGrams::new(columns, [[].as_slice()], y, group, groups).grams(0)
    }
}

/// Rows whose columns stay in the cache while all pairs are summed.
const TILE: usize = 256;

/// Adds the requested entries of the lower triangle of Σ xxᵀ over some rows to a row-major matrix.
fn add_products(columns: &[&[f64]], is_needed: impl Fn(usize, usize) -> bool, rows: Range<usize>, sums: &mut [f64]) {
    for start in rows.clone().step_by(TILE) {
        let tile = start..(start + TILE).min(rows.end);
        for (a, x) in columns.iter().enumerate() {
            for b in (0..=a).filter(|b| is_needed(a, *b)) {
                sums[a * columns.len() + b] += dot(&x[tile.clone()], &columns[b][tile.clone()]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joint_and_separate_products_are_equal() {
        let column = |k: usize| (0..700).map(|i| (0.3 * (k + 1) as f64 * i as f64).sin() + 0.1 * k as f64).collect();
        let all: Vec<Vec<f64>> = (0..6).map(column).collect();
        let group: Vec<usize> = (0..700).map(|i| [0, 2, 1, 0][i / 175]).collect();
        let (model, y) = ([all[0].as_slice(), &all[1]], all[5].as_slice());
        let sets: [&[Vec<f64>]; 3] = [&[], &all[2..4], &all[4..5]];
        let found = AugmentedGrams::new(&model, sets, y, &group, 3);
        for (k, set) in sets.into_iter().enumerate() {
            let grams = found.grams(k);
            let columns: Vec<&[f64]> = model.into_iter().chain(set.iter().map(Vec::as_slice)).collect();
            let p = columns.len();
            assert_eq!((grams.columns, &grams.rows), (p, &vec![350, 175, 175]));
            let of =
                |g: usize, a: &[f64], b: &[f64]| (0..700).filter(|i| group[*i] == g).map(|i| a[i] * b[i]).sum::<f64>();
            for g in 0..3 {
                for a in 0..p {
                    assert!((grams.xy(g)[a] - of(g, columns[a], y)).abs() < 1e-10);
                    for b in 0..p {
                        assert!((grams.xx(g)[a * p + b] - of(g, columns[a], columns[b])).abs() < 1e-10);
                    }
                }
                assert!((grams.yy[g] - of(g, y, y)).abs() < 1e-10);
            }
        }
    }
}
