//! How well the measurement repeats itself, from rows that should be equal but for noise.

use crate::prepare::Prepared;
use crate::report::NoiseFloor;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// From the residual, not from the response, so that small differences of speed or load between repeats cancel.
pub fn noise_floor(prepared: &Prepared, residual: &[f64]) -> NoiseFloor {
    let problem = &prepared.main;
    if problem.twins.len() < 8 {
        let source = "no noise floor: the run has no repeats of the same profile".to_owned();
        return NoiseFloor { rms: None, ci95: None, source, repeatable_share: None };
    }
    let mut by_block = vec![(0.0, 0.0); problem.blocks];
    let mut common = 0.0;
    for (a, b) in &problem.twins {
        let half = (residual[*a] - residual[*b]).powi(2) / 2.0;
        common += residual[*a] * residual[*b];
        let entry = &mut by_block[problem.block[*a]];
        entry.0 += half;
        entry.1 += 1.0;
    }
    let pairs = problem.twins.len() as f64;
    let variance = by_block.iter().map(|b| b.0).sum::<f64>() / pairs;
    // Jackknife over blocks: the pairs of one block are not independent of each other.
    let used: Vec<&(f64, f64)> = by_block.iter().filter(|b| b.1 > 0.0).collect();
    let groups = used.len() as f64;
    let without = |b: &(f64, f64)| (variance * pairs - b.0) / (pairs - b.1).max(1.0);
    let spread = (groups - 1.0) / groups * used.iter().map(|b| (without(b) - variance).powi(2)).sum::<f64>();
    let t = StudentsT::new(0.0, 1.0, (groups - 1.0).max(1.0)).map_or(2.0, |t| t.inverse_cdf(0.975));
    let reach = t * spread.sqrt();
    let common = (common / pairs).max(0.0);
    let share = if common + variance > 0.0 { common / (common + variance) } else { 0.0 };
    NoiseFloor {
        rms: Some(variance.sqrt()),
        ci95: Some([(variance - reach).max(0.0).sqrt(), (variance + reach).sqrt()]),
        source: format!(
            "{} pairs of the same condition and phase in different repeats ({})",
            problem.twins.len(),
            if prepared.about.repeats_from == "column" { "as numbered" } else { "found by the period of the motion" }
        ),
        repeatable_share: Some(share),
    }
}
