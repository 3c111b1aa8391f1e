//! Link latency: the durations of the exchanges with one instrument, as a histogram.

use serde::{Deserialize, Serialize};
use std::ops::AddAssign;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Upper bounds of the buckets in nanoseconds. One more bucket has no bound.
const BOUNDS_NS: [u64; 9] =
    [500_000, 1_000_000, 2_000_000, 5_000_000, 10_000_000, 20_000_000, 50_000_000, 100_000_000, 500_000_000];
const BUCKETS: usize = BOUNDS_NS.len() + 1;

/// Counts the exchanges of a link. Counting neither locks nor allocates.
#[derive(Debug, Default)]
pub struct LatencyCounter {
    counts: [AtomicU64; BUCKETS],
    sum_ns: AtomicU64,
}

impl LatencyCounter {
    /// Counts one exchange.
    pub fn add(&self, duration: Duration) {
        let duration_ns = u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX);
        let bucket = BOUNDS_NS.partition_point(|bound| *bound < duration_ns);
        self.counts[bucket].fetch_add(1, Ordering::Relaxed);
        self.sum_ns.fetch_add(duration_ns, Ordering::Relaxed);
    }

    /// The exchanges since the last call.
    pub fn take(&self) -> LinkLatency {
        let taken = |value: &AtomicU64| value.swap(0, Ordering::Relaxed);
        LinkLatency { counts: self.counts.each_ref().map(taken), sum_ns: taken(&self.sum_ns) }
    }
}

/// Exchanges with an instrument by their duration.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkLatency {
    counts: [u64; BUCKETS],
    sum_ns: u64,
}

impl LinkLatency {
    /// Number of exchanges.
    pub fn count(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// Sum of their durations [s].
    pub fn sum_s(&self) -> f64 {
        seconds(self.sum_ns)
    }

    /// Upper bound of each bucket [s], and the number of exchanges in this bucket alone. The last bound is infinite.
    pub fn buckets(&self) -> [(f64, u64); BUCKETS] {
        std::array::from_fn(|i| (BOUNDS_NS.get(i).map_or(f64::INFINITY, |bound| seconds(*bound)), self.counts[i]))
    }
}

impl AddAssign for LinkLatency {
    fn add_assign(&mut self, other: Self) {
        self.counts.iter_mut().zip(other.counts).for_each(|(count, more)| *count += more);
        self.sum_ns += other.sum_ns;
    }
}

fn seconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exchange_is_in_the_first_bucket_whose_bound_it_does_not_exceed() {
        let counter = LatencyCounter::default();
        [300, 500, 501, 700_000].into_iter().for_each(|us| counter.add(Duration::from_micros(us)));
        let mut total = counter.take();
        let filled = |latency: &LinkLatency| latency.buckets().into_iter().filter(|(_, count)| *count > 0).collect();
        let buckets: Vec<_> = filled(&total);
        assert_eq!(buckets, [(0.0005, 2), (0.001, 1), (f64::INFINITY, 1)]);
        assert_eq!((total.count(), total.sum_s()), (4, 0.701_301));

        assert_eq!(counter.take(), LinkLatency::default(), "an exchange is taken once");
        counter.add(Duration::from_millis(1));
        total += counter.take();
        let buckets: Vec<_> = filled(&total);
        assert_eq!(buckets, [(0.0005, 2), (0.001, 2), (f64::INFINITY, 1)]);
        assert_eq!((total.count(), total.sum_s()), (5, 0.702_301));
    }
}
