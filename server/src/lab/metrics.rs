//! State of the daemon in the text format of OpenMetrics, for Prometheus. Everything is read at the request.

use super::{Answer, Lab, LabError};
use crate::bench::{BenchHandle, bench_view};
use crate::view::{Bench, BenchState, NotificationTarget, word};
use jointbench_instrument::LinkLatency;
use prometheus_client::collector::Collector;
use prometheus_client::encoding::{DescriptorEncoder, EncodeMetric, MetricEncoder, NoLabelSet, text};
use prometheus_client::metrics::MetricType;
use prometheus_client::metrics::counter::ConstCounter;
use prometheus_client::metrics::gauge::ConstGauge;
use prometheus_client::registry::{Registry, Unit};
use std::fmt;

const STATES: [BenchState; 7] = [
    BenchState::Idle,
    BenchState::Running,
    BenchState::Paused,
    BenchState::Securing,
    BenchState::Stopped,
    BenchState::Fault,
    BenchState::Offline,
];

/// One value of a metric with its labels.
type Sample<V> = (Vec<(&'static str, String)>, V);

/// A metric with all its values.
struct Metric {
    name: &'static str,
    help: &'static str,
    unit: Option<Unit>,
    values: Values,
}

enum Values {
    Gauge(Vec<Sample<f64>>),
    Counter(Vec<Sample<u64>>),
    Latency(Vec<Sample<LinkLatency>>),
}

#[derive(Default)]
struct Metrics(Vec<Metric>);

impl Metrics {
    fn gauge(&mut self, name: &'static str, help: &'static str, unit: Option<Unit>, values: Vec<Sample<f64>>) {
        self.0.push(Metric { name, help, unit, values: Values::Gauge(values) });
    }
}

impl fmt::Debug for Metrics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.0.iter().map(|metric| metric.name)).finish()
    }
}

impl Collector for Metrics {
    fn encode(&self, mut encoder: DescriptorEncoder) -> fmt::Result {
        for Metric { name, help, unit, values } in &self.0 {
            match values {
                Values::Gauge(values) => {
                    let values = values.iter().map(|(labels, value)| (labels, ConstGauge::new(*value)));
                    encode(&mut encoder, name, help, unit.as_ref(), values)?;
                }
                Values::Counter(values) => {
                    let values = values.iter().map(|(labels, value)| (labels, ConstCounter::new(*value)));
                    encode(&mut encoder, name, help, unit.as_ref(), values)?;
                }
                Values::Latency(values) => {
                    let values = values.iter().map(|(labels, value)| (labels, LatencyHistogram(value)));
                    encode(&mut encoder, name, help, unit.as_ref(), values)?;
                }
            }
        }
        Ok(())
    }
}

struct LatencyHistogram<'a>(&'a LinkLatency);

impl EncodeMetric for LatencyHistogram<'_> {
    fn encode(&self, mut encoder: MetricEncoder) -> fmt::Result {
        let LatencyHistogram(latency) = self;
        encoder.encode_histogram::<NoLabelSet>(latency.sum_s(), latency.count(), &latency.buckets(), None)
    }

    fn metric_type(&self) -> MetricType {
        MetricType::Histogram
    }
}

fn encode<'v, M: EncodeMetric>(
    encoder: &mut DescriptorEncoder,
    name: &str,
    help: &str,
    unit: Option<&Unit>,
    values: impl Iterator<Item = (&'v Vec<(&'static str, String)>, M)>,
) -> fmt::Result {
    let mut values = values.peekable();
    let Some((_, first)) = values.peek() else { return Ok(()) };
    let mut family = encoder.encode_descriptor(name, help, unit, first.metric_type())?;
    for (labels, value) in values {
        value.encode(family.encode_family(labels)?)?;
    }
    Ok(())
}

impl Lab {
    /// All metrics. Names begin with `jointbench_`.
    pub async fn metrics(&self) -> Answer<String> {
        let mut metrics = Metrics::default();
        let benches = &self.inner.benches;
        let views: Vec<Bench> = benches.iter().map(|bench| bench_view(bench.description(), &bench.status())).collect();
        bench_metrics(&mut metrics, &views);
        link_metrics(&mut metrics, benches);
        self.queue_metrics(&mut metrics).await?;
        self.notification_metrics(&mut metrics).await?;
        self.archive_metrics(&mut metrics).await?;
        let runs = self.inner.store.run_counts().await?.into_iter().map(|(labels, count)| {
            let [bench, procedure, state] = labels;
            (vec![("bench", bench), ("procedure", procedure), ("state", state)], count)
        });
        let values = Values::Counter(runs.collect());
        metrics.0.push(Metric { name: "runs", help: "Ended runs in the store by state", unit: None, values });
        let health = self.store_health();
        let damage = (health.damaged.len() + health.lost.len()) as f64;
        let help = "Damaged and lost records that the latest check of the store found";
        metrics.gauge("store_damaged_records", help, None, vec![(Vec::new(), damage)]);

        let mut registry = Registry::with_prefix("jointbench");
        registry.register_collector(Box::new(metrics));
        for bench in benches {
            bench_totals(&mut registry, bench);
        }
        let mut text = String::new();
        text::encode(&mut text, &registry).map_err(|fault| LabError::Internal(fault.to_string()))?;
        Ok(text)
    }

    async fn queue_metrics(&self, metrics: &mut Metrics) -> Answer<()> {
        let queues = self.queues().await?;
        let of = |value: fn(&crate::view::BenchQueue) -> f64| {
            queues.iter().map(|queue| (vec![("bench", queue.bench.clone())], value(queue))).collect()
        };
        metrics.gauge("queue_entries", "Runs that wait for the bench", None, of(|queue| queue.entries.len() as f64));
        let paused = of(|queue| f64::from(queue.paused.is_some()));
        metrics.gauge("queue_paused", "1: the queue waits for a person or a script", None, paused);
        Ok(())
    }

    async fn notification_metrics(&self, metrics: &mut Metrics) -> Answer<()> {
        let targets = self.notification_targets().await?;
        let of = |value: fn(&NotificationTarget) -> u64| {
            targets.iter().map(|target| (vec![("target", target.name.clone())], value(target) as f64)).collect()
        };
        let help = "Messages that wait for their delivery";
        metrics.gauge("notifications_pending", help, None, of(|target| target.pending));
        let help = "Messages of the last days that were not delivered within a day";
        metrics.gauge("notifications_failed", help, None, of(|target| target.failed));
        Ok(())
    }

    /// Without an archive there are none.
    async fn archive_metrics(&self, metrics: &mut Metrics) -> Answer<()> {
        let archive = self.archive().await?;
        if archive.url.is_some() {
            let of = |value: u64| vec![(Vec::new(), value as f64)];
            metrics.gauge("archive_owed", "Tables of runs that wait to be archived", None, of(archive.owed));
            let help = "Tables that cannot be archived until a person acts";
            metrics.gauge("archive_failed", help, None, of(archive.failed));
        }
        Ok(())
    }
}

/// An instrument without an exchange since the start of the daemon has none.
fn link_metrics(metrics: &mut Metrics, benches: &[BenchHandle]) {
    let links = benches.iter().flat_map(|bench| {
        let labels = |instrument| vec![("bench", bench.name().to_owned()), ("instrument", instrument)];
        bench.link_latency().into_iter().map(move |(instrument, latency)| (labels(instrument), latency))
    });
    let (name, unit) = ("link", Some(Unit::Seconds));
    let help = "Link latency: duration of an exchange with an instrument, until its reply or its deadline";
    metrics.0.push(Metric { name, help, unit, values: Values::Latency(links.collect()) });
}

/// What a bench counts since the start of the daemon.
fn bench_totals(registry: &mut Registry, bench: &BenchHandle) {
    let labels = [("bench".into(), bench.name().to_owned().into())];
    let registry = registry.sub_registry_with_labels(labels.into_iter());
    let help = "Duration of a transaction of the store";
    registry.register_with_unit("commit", help, Unit::Seconds, bench.commit_times());
    let help = "Set-points of finished steps that were sent more than one period after their time";
    registry.register("late_ticks", help, bench.late_ticks());
}

fn bench_metrics(metrics: &mut Metrics, benches: &[Bench]) {
    let name = |bench: &Bench| ("bench", bench.name.clone());
    let of = |value: fn(&Bench) -> f64| benches.iter().map(|bench| (vec![name(bench)], value(bench))).collect();
    let states = benches.iter().flat_map(|bench| {
        let labels = move |state: BenchState| vec![name(bench), ("state", word(state))];
        STATES.into_iter().map(move |state| (labels(state), f64::from(bench.state == state)))
    });
    metrics.gauge("bench_state", "1 for the present state of the bench", None, states.collect());
    let blocked = of(|bench| f64::from(bench.blocked.is_some()));
    metrics.gauge("bench_blocked", "1: no run starts until a person resets the bench", None, blocked);
    let unsafe_ = of(|bench| f64::from(bench.blocked.as_ref().is_some_and(|block| !block.stopped)));
    metrics.gauge("bench_unsafe", "1: the safe state of the bench is not confirmed", None, unsafe_);
    let rows = of(|bench| bench.unstored.as_ref().map_or(0.0, |unstored| unstored.rows as f64));
    metrics.gauge("unstored_samples", "Recorded samples that are not stored yet", None, rows);
    let instruments = benches.iter().flat_map(|bench| {
        let labels = move |instrument: &str| vec![name(bench), ("instrument", instrument.to_owned())];
        bench.instruments.iter().map(move |one| (labels(&one.name), f64::from(one.ready)))
    });
    metrics.gauge("instrument_ready", "1: the instrument responds", None, instruments.collect());
    let channels = benches.iter().flat_map(|bench| bench.channels.iter().map(move |channel| (bench, channel)));
    let labels = |bench: &Bench, channel: &str| vec![name(bench), ("channel", channel.to_owned())];
    let missing = channels.clone().map(|(bench, one)| (labels(bench, &one.name), one.dropped as f64));
    metrics.gauge("missing_samples", "Missing samples of the present or latest run", None, missing.collect());
    let ages = channels.filter_map(|(bench, one)| Some((labels(bench, &one.name), one.age_s?)));
    metrics.gauge("sample_age", "Age of the newest value of a channel", Some(Unit::Seconds), ages.collect());
}
