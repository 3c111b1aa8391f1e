//! Statistics of a window of samples.

use super::{Answer, Lab};
use crate::job::Job;
use crate::view::ChannelStatistics;

/// Limit of the rows in memory.
pub(super) const ROWS_AT_ONCE: u64 = 1 << 18;

impl Lab {
    /// Uses every row with `from_s ≤ time ≤ to_s`: the minima and maxima of a plot do not give a mean.
    pub async fn statistics(
        &self,
        id: i64,
        channels: Option<&[String]>,
        from_s: Option<f64>,
        to_s: Option<f64>,
    ) -> Answer<Vec<ChannelStatistics>> {
        let channels = channels.map(<[String]>::to_vec);
        self.compute(Job::Statistics { run: id, channels, from_s, to_s }).await
    }

    pub(super) async fn statistics_here(
        &self,
        id: i64,
        channels: Option<&[String]>,
        from_s: Option<f64>,
        to_s: Option<f64>,
    ) -> Answer<Vec<ChannelStatistics>> {
        let store = &self.inner.store;
        let rows = store.rows_between(id, from_s, to_s).await?;
        let none = store.trace(id, channels, 0..0).await?;
        let mut figures = vec![Figures::default(); none.channels().len()];
        let mut first = rows.start;
        while first < rows.end {
            let last = (first + ROWS_AT_ONCE).min(rows.end);
            let trace = store.trace(id, channels, first..last).await?;
            for (figures, values) in figures.iter_mut().zip(trace.columns()) {
                values.iter().filter(|value| value.is_finite()).for_each(|value| figures.take(*value));
            }
            first = last;
        }
        Ok(none.channels().iter().zip(figures).map(|(channel, figures)| figures.of(channel)).collect())
    }
}

/// Welford's running mean and squares about it: no cancellation for a large mean.
#[derive(Debug, Clone, Copy)]
pub(super) struct Figures {
    pub n: u64,
    pub mean: f64,
    pub squares: f64,
    min: f64,
    max: f64,
}

impl Default for Figures {
    fn default() -> Self {
        Self { n: 0, mean: 0.0, squares: 0.0, min: f64::INFINITY, max: f64::NEG_INFINITY }
    }
}

impl Figures {
    pub fn take(&mut self, value: f64) {
        self.n += 1;
        let off = value - self.mean;
        self.mean += off / self.n as f64;
        self.squares += off * (value - self.mean);
        self.min = self.min.min(value);
        self.max = self.max.max(value);
    }

    fn of(self, channel: &jointbench_instrument::Channel) -> ChannelStatistics {
        let n = self.n as f64;
        let some = |figure: f64| (self.n > 0).then_some(figure);
        ChannelStatistics {
            name: channel.name.clone(),
            unit: channel.unit().map(str::to_owned),
            n: self.n,
            mean: some(self.mean),
            deviation: (self.n > 1).then(|| (self.squares / (n - 1.0)).sqrt()),
            rms: some((self.mean * self.mean + self.squares / n).sqrt()),
            min: some(self.min),
            max: some(self.max),
        }
    }
}
