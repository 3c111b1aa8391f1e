//! Currents in steps: during a change, the readings of current and torque and the coil current belong to different
//! moments.

use crate::stats::summary::mean;
use crate::thresholds::{DWELL_CHANGE, DWELL_NOISE, DWELL_NOISES};

/// For each chunk of `n` samples: whether the current is constant there and in a margin before and after. Empty if
/// the current has no steps.
pub fn held(current: &[f64], n: usize) -> Vec<bool> {
    let means: Vec<f64> = current.chunks(n).map(mean).collect();
    let steps: Vec<f64> = means.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    let mut sorted = steps.clone();
    sorted.sort_by(f64::total_cmp);
    let usual = sorted.get(sorted.len() * 9 / 10).copied().unwrap_or(0.0);
    let noise = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    // If the current changes all the time, its median change is no noise.
    if usual == 0.0 || noise > DWELL_NOISE * usual {
        return Vec::new();
    }
    let changes = (0..steps.len()).filter(|k| steps[*k] > (DWELL_CHANGE * usual).max(DWELL_NOISES * noise));
    let margin = freshness(current).div_ceil(n) + 1;
    let mut held = vec![true; means.len()];
    for k in changes {
        let last = (k + 1 + margin).min(held.len() - 1);
        held[(k + 1).saturating_sub(margin)..=last].fill(false);
    }
    held
}

/// Samples for which one reading is repeated while the current changes.
fn freshness(current: &[f64]) -> usize {
    let mut lengths: Vec<usize> = current.chunk_by(|a, b| a == b).map(<[f64]>::len).collect();
    lengths.sort_unstable();
    lengths.get(lengths.len() / 2).copied().unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step every 100 samples with exponential settling, read every tenth sample.
    fn steps() -> Vec<f64> {
        let current = |i: usize| {
            let since = (i % 100) as f64;
            0.1 * ((i / 100) as f64 - (-since / 8.0).exp())
        };
        (0..1000).map(|i| current(i / 10 * 10)).collect()
    }

    #[test]
    fn a_change_and_its_surroundings_are_omitted() {
        let held = held(&steps(), 4);
        let kept: Vec<usize> = (0..25).filter(|k| held[25 * 5 + k]).collect();
        assert!(kept.first().is_some_and(|k| (8..20).contains(k)), "{kept:?}");
        assert!(kept.last().is_some_and(|k| (19..24).contains(k)), "the reading may come late: {kept:?}");
    }

    #[test]
    fn a_ramp_and_a_swing_have_no_holds() {
        let ramp: Vec<f64> = (0..1000).map(|i| 1e-3 * f64::from(i) + 1e-4 * f64::from(i % 3)).collect();
        let swing: Vec<f64> = (0..1000).map(|i| (0.01 * f64::from(i)).sin()).collect();
        assert!(held(&ramp, 4).is_empty() && held(&swing, 4).is_empty());
        assert!(held(&[0.5; 100], 4).is_empty(), "a constant current has no steps");
    }
}
