//! Linear fits from one pass over the rows: the Gram matrices of blocks, on which selection and intervals are based.

use crate::{least_s, line, peer, show};
use jointbench_model::linear::{AugmentedGrams, BlockGrams, Cholesky};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

const MODEL: usize = 12;
const CANDIDATES: usize = 28;
const BLOCKS: usize = 100;
const REPLICATES: usize = 1000;
/// The candidate that the response contains.
const HIDDEN: usize = 17;

/// Columns have very different sizes.
fn size(column: usize) -> f64 {
    10f64.powi(column as i32 % 5)
}

pub fn measure(rows: usize) {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
    let columns: Vec<Vec<f64>> =
        (0..MODEL + CANDIDATES).map(|c| (0..rows).map(|_| size(c) * (noise() + 0.3)).collect()).collect();
    let noise: Vec<f64> = (0..rows).map(|_| noise()).collect();
    let terms: Vec<(f64, &Vec<f64>)> =
        (0..MODEL).chain([MODEL + HIDDEN]).map(|c| (0.4 / size(c), &columns[c])).collect();
    let y: Vec<f64> = (0..rows).map(|i| noise[i] + terms.iter().map(|(share, c)| share * c[i]).sum::<f64>()).collect();
    let block: Vec<usize> = (0..rows).map(|i| i * BLOCKS / rows).collect();

    let model: Vec<&[f64]> = columns[..MODEL].iter().map(Vec::as_slice).collect();
    let with_response: Vec<&[f64]> = model.iter().copied().chain([y.as_slice()]).collect();
    let (read_s, _) = least_s(15, || with_response.iter().map(|c| sum(c)).sum::<f64>());
    let (here_s, coefficients) = least_s(15, || {
        let (xx, xy) = BlockGrams::new(&model, &y, &block, BLOCKS).total();
        Cholesky::new(&xx, MODEL, 0.0).solve(&xy)
    });
    let what = format!("linear fit of {rows} rows × {MODEL} regressors, {BLOCKS} Gram matrices");
    println!("| {what} | {} | one read of memory: {} | {:.1} | ≤ 6 |", show(here_s), show(read_s), here_s / read_s);
    let scipy = peer::ask("linear", &with_response);
    for (here, there) in coefficients.iter().zip(scipy.iter().flat_map(|(_, coefficients)| coefficients)) {
        assert!((here / there - 1.0).abs() < 1e-8, "{here} here, {there} there");
    }
    line("the same", here_s, "SciPy lstsq, gelsy", scipy.map(|b| b.0), 8.0);

    let all: Vec<&[f64]> = columns.iter().chain([&y]).map(Vec::as_slice).collect();
    let each = || {
        let grams = AugmentedGrams::new(&model, columns[MODEL..].chunks(1), &y, &block, BLOCKS);
        (0..CANDIDATES).map(|k| grams.grams(k)).collect::<Vec<_>>()
    };
    let (here_s, best) = least_s(9, || ranking(&each()));
    assert_eq!(best, HIDDEN);
    let scipy = peer::ask("ranking", &all);
    if let Some((_, errors)) = &scipy {
        assert_eq!(best_of(errors), HIDDEN);
    }
    let what = format!("{CANDIDATES} candidates ranked by validation error over {BLOCKS} blocks");
    line(&what, here_s, "SciPy, each refitted, no validation error", scipy.map(|b| b.0), 80.0);

    let (here_s, _) = least_s(3, || {
        let each = each();
        let mut random = ChaCha8Rng::seed_from_u64(2);
        (0..REPLICATES).filter(|_| bootstrap(&each, &mut random) == HIDDEN).count()
    });
    let scipy_s = peer::ask("replicate", &all).map(|b| b.0 * REPLICATES as f64);
    let what = format!("{REPLICATES} block bootstraps of the ranking by squared error");
    line(&what, here_s, "SciPy, extrapolated from one", scipy_s, 5000.0);
}

/// Speed limit of memory: sums that are independent of each other.
fn sum(column: &[f64]) -> f64 {
    let mut sums = [0.0; 16];
    for numbers in column.chunks_exact(16) {
        sums.iter_mut().zip(numbers).for_each(|(s, v)| *s += v);
    }
    sums.iter().sum()
}

/// The candidate with the smallest validation error of the model.
fn ranking(each: &[BlockGrams]) -> usize {
    best_of(&each.par_iter().map(|grams| grams.validation_losses().iter().sum()).collect::<Vec<f64>>())
}

/// The candidate with the largest error reduction in a bootstrap sample of blocks.
fn bootstrap(each: &[BlockGrams], random: &mut ChaCha8Rng) -> usize {
    let drawn: Vec<usize> = (0..BLOCKS).map(|_| random.random_range(0..BLOCKS)).collect();
    let left = |grams: &BlockGrams| {
        let (xx, xy) = grams.sum(drawn.iter().copied());
        let explained = Cholesky::new(&xx, MODEL + 1, 0.0).whiten(&xy);
        -explained.iter().map(|v| v * v).sum::<f64>()
    };
    best_of(&each.iter().map(left).collect::<Vec<_>>())
}

fn best_of(losses: &[f64]) -> usize {
    (0..losses.len()).min_by(|a, b| losses[*a].total_cmp(&losses[*b])).expect("there are candidates")
}
