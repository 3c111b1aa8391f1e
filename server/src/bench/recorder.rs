//! Keeps what a run brings: durable in the store first, then shown to whoever watches.

use super::health::Health;
use super::status::{Met, Status, readings};
use super::thread::Start;
use crate::lab::{run_event, state_view};
use crate::live::Rows;
use crate::view::{BenchState, LiveMessage, Progress};
use jiff::Timestamp;
use jointbench_devices::MockBench;
use jointbench_instrument::{Channel, Trace};
use jointbench_model::transfer::Alongside;
use jointbench_procedure::{Commit, EventKind, Live, Recorder, RecorderFault, RunId, RunState};
use std::time::{Duration, Instant};
use tokio::runtime::Handle;
use tokio::sync::watch;

/// A mock bench outruns the clock on the wall; eyes do not.
const PROGRESS_EVERY: Duration = Duration::from_millis(100);
/// Limits and channels of a bench.
const BENCH_EVERY: Duration = Duration::from_millis(500);

pub(super) struct StoreRecorder<'a> {
    start: &'a Start,
    status: &'a watch::Sender<Status>,
    runtime: &'a Handle,
    /// Its disk may have a bad day, which is the store's.
    mock: Option<&'a MockBench>,
    run: RunId,
    /// The last model of the bench, beside what is measured. `None` from where it cannot tell.
    model: Option<Alongside>,
    health: Health,
    told_events: u64,
    told_progress: Option<Instant>,
    told_bench: Option<Instant>,
    began: Instant,
    state: RunState,
    faults: Vec<Met>,
}

impl<'a> StoreRecorder<'a> {
    pub fn new(
        start: &'a Start,
        status: &'a watch::Sender<Status>,
        runtime: &'a Handle,
        mock: Option<&'a MockBench>,
        run: RunId,
        model: Option<Alongside>,
        rate_hz: f64,
    ) -> Self {
        Self {
            start,
            status,
            runtime,
            mock,
            run,
            model,
            health: Health::new(rate_hz),
            told_events: 0,
            told_progress: None,
            told_bench: None,
            began: Instant::now(),
            state: RunState::Queued,
            faults: Vec::new(),
        }
    }

    pub fn into_faults(self) -> Vec<Met> {
        self.faults
    }

    fn bench(&self) -> &str {
        &self.start.description.name
    }

    fn tell_state(&mut self, state: RunState) {
        if state == self.state {
            return;
        }
        self.state = state;
        self.status.send_modify(|status| {
            status.run = Some(self.run);
            status.state = match state {
                RunState::Paused => BenchState::Paused,
                RunState::Securing => BenchState::Securing,
                _ => BenchState::Running,
            };
        });
        // The end is told with its reason, by `end`.
        if !state.is_final() {
            let message = LiveMessage::State {
                bench: self.bench().to_owned(),
                run: self.run,
                state: state_view(state),
                safe: None,
                reason: None,
            };
            self.start.hub.tell(message);
        }
        self.tell_bench();
    }

    fn tell_bench(&mut self) {
        self.told_bench = Some(Instant::now());
        let bench = crate::lab::bench_view(&self.start.description, &self.status.borrow());
        self.start.hub.tell(LiveMessage::Bench { bench: Box::new(bench) });
    }

    /// The rows with the torque of the motor, as measured and as the model has it.
    fn beside_model(&mut self, rows: Trace) -> Trace {
        let Some([measured, predicted]) = self.model.as_mut().and_then(|model| model.tell(&rows)) else {
            self.model = None;
            return rows;
        };
        let (mut channels, mut columns) = rows.into_parts();
        channels.extend(["motor_torque_nm", "model_torque_nm"].map(Channel::new));
        columns.extend([measured, predicted]);
        Trace::from_columns(channels, columns)
    }

    /// Tells the journal's new lines with the numbers that the store gave them.
    fn tell_events(&mut self) {
        let events = self.runtime.block_on(self.start.store.events(self.run, self.told_events));
        for event in events.unwrap_or_default() {
            self.told_events = event.sequence;
            let (bench, event) = (self.bench().to_owned(), run_event(event));
            self.start.hub.tell(LiveMessage::Event { bench, run: self.run, event });
        }
    }
}

impl Recorder for StoreRecorder<'_> {
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        let block = self.runtime.block_on(self.start.store.bench_block(self.bench())).map_err(fault)?;
        Ok(block.map(|block| block.reason))
    }

    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault> {
        let Commit { run, state, events, rows } = commit;
        let store = &self.start.store;
        self.faults.extend(events.iter().filter_map(|event| match &event.kind {
            EventKind::Fault { fault, recovered } => {
                Some(Met { at: Timestamp::now(), fault: fault.clone(), recovered: *recovered })
            }
            _ => None,
        }));
        if let Some(mock) = self.mock {
            self.runtime.block_on(store.fill_disk(mock.disk_is_full())).map_err(fault)?;
        }
        self.runtime.block_on(store.commit(run, state, events, rows)).map_err(fault)?;
        self.tell_state(state);
        self.tell_events();
        Ok(())
    }

    fn live(&mut self, live: Live<'_>) {
        self.health.add(live.rows);
        let rows = self.beside_model(live.rows.clone());
        self.start.hub.show(Rows { bench: self.bench().to_owned(), run: live.run, rows });
        if self.told_progress.is_some_and(|told| told.elapsed() < PROGRESS_EVERY) {
            return;
        }
        self.told_progress = Some(Instant::now());
        // The time of a mock bench may run faster than that of the person who waits.
        let elapsed_s = self.began.elapsed().as_secs_f64();
        let wall = if live.progress.elapsed_s > 0.0 { elapsed_s / live.progress.elapsed_s } else { 1.0 };
        let progress = Progress {
            step: live.progress.step,
            steps: live.progress.steps,
            label: live.progress.label.clone(),
            elapsed_s,
            remaining_s: live.progress.remaining_s * wall,
        };
        let message =
            LiveMessage::Progress { bench: self.bench().to_owned(), run: live.run, progress: progress.clone() };
        self.start.hub.tell(message);
        let readings = readings(live.rows, self.start.description.constants.gear_ratio);
        let channels = self.health.told(Timestamp::now());
        self.status.send_modify(|status| {
            status.progress = Some(progress);
            status.readings = readings;
            status.channels = channels;
        });
        if self.told_bench.is_none_or(|told| told.elapsed() >= BENCH_EVERY) {
            self.tell_bench();
        }
    }
}

fn fault(fault: crate::store::StoreError) -> RecorderFault {
    RecorderFault(fault.to_string())
}
