//! Gram matrices that can be merged: number of rows, means, and centred sums of products of some columns.
//!
//! The state of `width` columns is one slice of [`length`] numbers: the number of rows, the means, and the lower
//! triangle of the sums of products about the means, row by row. Two states of different rows are merged without a
//! second pass and without loss of digits (Chan, Golub, LeVeque 1983).

use crate::linear::gram::BlockGrams;

/// Numbers in the state of `width` columns.
pub const fn length(width: usize) -> usize {
    1 + width + width * (width + 1) / 2
}

/// Number of columns of a state. `None` for a length that no state has.
pub fn width(length: usize) -> Option<usize> {
    (0..=length).take_while(|width| self::length(*width) <= length).find(|width| self::length(*width) == length)
}

/// Adds one row to a state. `row` has one value for each column.
pub fn add_row(state: &mut [f64], row: &[f64]) {
    let (head, products) = state.split_at_mut(1 + row.len());
    let before = head[0];
    head[0] += 1.0;
    let share = before / head[0];
    let mut at = 0;
    for (i, x) in row.iter().enumerate() {
        let change = share * (x - head[1 + i]);
        for (y, mean) in row[..=i].iter().zip(&head[1..]) {
            products[at] += change * (y - mean);
            at += 1;
        }
    }
    row.iter().zip(&mut head[1..]).for_each(|(x, mean)| *mean += (x - *mean) / (before + 1.0));
}

/// Adds the rows of another state of the same columns.
pub fn merge(state: &mut [f64], other: &[f64], width: usize) {
    let rows = state[0] + other[0];
    if other[0] == 0.0 {
        return;
    }
    let scale = state[0] * other[0] / rows;
    let mut at = 1 + width;
    for i in 0..width {
        let change = scale * (other[1 + i] - state[1 + i]);
        for j in 0..=i {
            state[at] += other[at] + change * (other[1 + j] - state[1 + j]);
            at += 1;
        }
    }
    let share = other[0] / rows;
    (1..=width).for_each(|i| state[i] += share * (other[i] - state[i]));
    state[0] = rows;
}

impl BlockGrams {
    /// Gram matrices of blocks from their states, about zero. The first column of a state is the response, and each
    /// state has [`length`]`(1 + columns)` numbers.
    pub fn of_moments<'s>(states: impl IntoIterator<Item = &'s [f64]>, columns: usize) -> Self {
        let mut grams = Self::empty(columns, Vec::new());
        for state in states {
            let (mean, products) = state[1..].split_at(1 + columns);
            let product = |a: usize, b: usize| products[a * (a + 1) / 2 + b] + state[0] * mean[a] * mean[b];
            for a in 1..=columns {
                grams.xx.extend((1..=columns).map(|b| product(a.max(b), a.min(b))));
                grams.xy.push(product(a, 0));
            }
            grams.yy.push(product(0, 0));
            grams.rows.push(state[0] as usize);
        }
        grams.groups = grams.rows.len();
        grams
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(n: usize) -> Vec<[f64; 3]> {
        (0..n).map(|i| i as f64).map(|i| [(0.7 * i).sin(), 1e6 + (0.3 * i).cos(), 0.01 * i]).collect()
    }

    fn state(rows: &[[f64; 3]]) -> Vec<f64> {
        let mut state = vec![0.0; length(3)];
        rows.iter().for_each(|row| add_row(&mut state, row));
        state
    }

    #[test]
    fn merged_blocks_have_the_moments_of_all_rows() {
        let rows = rows(50);
        let whole = state(&rows);
        let mut merged = state(&[]);
        for block in [&rows[..7], &[], &rows[7..30], &rows[30..]] {
            merge(&mut merged, &state(block), 3);
        }
        // The values of the second column, near 1e6, are themselves rounded to 1e-10.
        for (a, b) in merged.iter().zip(&whole) {
            assert!((a - b).abs() <= 1e-9 * b.abs().max(1.0), "{merged:?} {whole:?}");
        }
        // The second column has the mean 1e6: sums about zero would have lost these digits.
        let variance = whole[1 + 3 + 2] / 50.0;
        let mean = rows.iter().map(|r| r[1] - 1e6).sum::<f64>() / 50.0;
        let expected = rows.iter().map(|r| (r[1] - 1e6 - mean).powi(2)).sum::<f64>() / 50.0;
        assert!((variance - expected).abs() < 1e-9, "{variance} {expected}");
    }

    #[test]
    fn blocks_of_moments_are_the_blocks_of_the_rows() {
        let rows: Vec<[f64; 3]> = rows(40).into_iter().map(|[y, a, b]| [y, a - 1e6, b]).collect();
        let column = |k: usize| -> Vec<f64> { rows.iter().map(|row| row[k]).collect() };
        let (y, a, b) = (column(0), column(1), column(2));
        let group: Vec<usize> = (0..40).map(|row| row / 8).collect();
        let expected = BlockGrams::new(&[&a, &b], &y, &group, 5);
        let states: Vec<Vec<f64>> = rows.chunks(8).map(state).collect();
        let found = BlockGrams::of_moments(states.iter().map(Vec::as_slice), 2);
        assert_eq!((found.groups, &found.rows), (5, &vec![8; 5]));
        for (found, expected) in [(&found.xx, &expected.xx), (&found.xy, &expected.xy), (&found.yy, &expected.yy)] {
            assert_eq!(found.len(), expected.len());
            found.iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-12, "{a} {b}"));
        }
    }

    #[test]
    fn a_length_has_at_most_one_width() {
        assert_eq!([0, 1, 3, 4, 6, 10].map(width), [None, Some(0), Some(1), None, Some(2), Some(3)]);
    }
}
