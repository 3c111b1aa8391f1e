//! Blocks of a run over which columns are compared.

use crate::thresholds::CHECK_BLOCK_S;
use std::ops::Range;

/// A block that does not cross the end of a recording, and its duration [s].
pub type Block = (Range<usize>, f64);

/// All blocks in the order of time.
pub fn blocks(time_s: &[f64]) -> Vec<Block> {
    let step_s = crate::preprocess::sample_s(time_s);
    let n = ((CHECK_BLOCK_S / step_s) as usize).max(1);
    let block = |start| {
        let passed_s = time_s[start + n] - time_s[start];
        (passed_s > 0.0 && passed_s < 2.0 * n as f64 * step_s).then_some((start..start + n, passed_s))
    };
    (0..time_s.len().saturating_sub(n)).step_by(n).filter_map(block).collect()
}
