//! Shows the live data of a run. This data may not be durable yet; the status of the bench reports that.

use super::health::Health;
use super::shared::Shared;
use super::status::readings;
use crate::live::Rows;
use crate::view::{LiveMessage, Progress};
use jiff::Timestamp;
use jointbench_instrument::{Channel, Trace};
use jointbench_model::export::OnlinePrediction;
use jointbench_procedure::{self as procedure, RunId};
use std::time::{Duration, Instant};

/// Limits the update rate of the display, because a mock bench may run faster than real time.
const PROGRESS_EVERY: Duration = Duration::from_millis(100);
/// Weight of the mock bench's nominal pace in the estimate, as run time [s].
const PACE_HOLDS_S: f64 = 2.0;
/// Update interval of limits and channels.
const BENCH_EVERY: Duration = Duration::from_millis(500);

pub(super) struct Display {
    /// The last model of the bench, evaluated with the live data. `None` after the first failure.
    model: Option<OnlinePrediction>,
    health: Health,
    progress_at: Option<Instant>,
    bench_at: Option<Instant>,
    began: Instant,
}

impl Display {
    pub fn new(model: Option<OnlinePrediction>, rate_hz: f64) -> Self {
        Self { model, health: Health::new(rate_hz), progress_at: None, bench_at: None, began: Instant::now() }
    }

    pub fn show(&mut self, shared: &Shared, run: RunId, rows: Trace, progress: &procedure::Progress) {
        self.health.add(&rows);
        let bench = shared.name().to_owned();
        let newest = readings(&rows, shared.description.constants.gear_ratio);
        shared.hub.publish_rows(Rows { bench: bench.clone(), run, rows: self.with_model_torque(rows) });
        if self.progress_at.is_some_and(|at| at.elapsed() < PROGRESS_EVERY) {
            return;
        }
        self.progress_at = Some(Instant::now());
        let progress = self.in_wall_time(shared.description.pace(), progress);
        shared.hub.publish(LiveMessage::Progress { bench, run, progress: progress.clone() });
        let channels = self.health.channels(Timestamp::now());
        shared.status.send_modify(|status| {
            status.progress = Some(progress);
            status.readings = newest;
            status.channels = channels;
        });
        if self.bench_at.is_none_or(|at| at.elapsed() >= BENCH_EVERY) {
            self.bench_at = Some(Instant::now());
            shared.publish_bench();
        }
    }

    /// Converts the remaining time of a mock bench to wall-clock time, limited by its pace. The nominal pace is the
    /// initial estimate, because the first moments of a run include its start.
    fn in_wall_time(&self, pace: Option<f64>, progress: &procedure::Progress) -> Progress {
        let elapsed_s = self.began.elapsed().as_secs_f64();
        let wall = match pace {
            Some(pace) => ((elapsed_s + PACE_HOLDS_S) / (progress.elapsed_s + PACE_HOLDS_S * pace)).max(1.0 / pace),
            None if progress.elapsed_s > 0.0 => elapsed_s / progress.elapsed_s,
            None => 1.0,
        };
        let remaining_s = progress.remaining_s * wall;
        let whole_s = elapsed_s + remaining_s;
        Progress {
            step: progress.step,
            steps: progress.steps,
            label: progress.label.clone(),
            elapsed_s,
            remaining_s,
            fraction: if whole_s > 0.0 { elapsed_s / whole_s } else { 0.0 },
            at_most: progress.at_most,
        }
    }

    /// Adds the measured and the predicted motor torque to the rows.
    fn with_model_torque(&mut self, rows: Trace) -> Trace {
        let Some([measured, predicted]) = self.model.as_mut().and_then(|model| model.push(&rows)) else {
            self.model = None;
            return rows;
        };
        let (mut channels, mut columns) = rows.into_parts();
        channels.extend(["motor_torque_nm", "model_torque_nm"].map(Channel::new));
        columns.extend([measured, predicted]);
        Trace::from_columns(channels, columns)
    }
}
