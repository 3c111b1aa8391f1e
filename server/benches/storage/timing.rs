//! Seconds of a piece of work.

use std::future::Future;
use std::time::Instant;

pub async fn seconds<T>(work: impl Future<Output = T>) -> (f64, T) {
    let start = Instant::now();
    let done = work.await;
    (start.elapsed().as_secs_f64(), done)
}

/// The value below which a share of the measurements lies.
pub fn quantile(measured: &mut [f64], share: f64) -> f64 {
    measured.sort_by(f64::total_cmp);
    measured[((measured.len() - 1) as f64 * share).round() as usize]
}
