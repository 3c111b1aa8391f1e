//! Instruments on one shaft of the mock bench: their lag beyond their time stamps, from their readings.

use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::roles::{CounterReading, EncoderStatus, Identity, Instrument, PositionCounter};
use jointbench_instrument::units::Radians;
use jointbench_instrument::{Bench, Fault};
use jointbench_procedure::plan::Plan;
use jointbench_procedure::profile::Profile;
use jointbench_procedure::{BenchFacts, Commit, EventKind, Live, Recorder, RecorderFault, RunState, procedure, run};
use serde_json::json;
use std::path::Path;
use std::sync::mpsc::channel;

#[derive(Default)]
struct Notes(Vec<String>);

impl Recorder for Notes {
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        Ok(None)
    }

    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault> {
        let notes = commit.events.iter().filter_map(|event| match &event.kind {
            EventKind::Note { text } => Some(text.clone()),
            _ => None,
        });
        self.0.extend(notes);
        Ok(())
    }

    fn live(&mut self, _live: Live<'_>) {}
}

fn start() -> (MockBench, Bench) {
    let mock = MockBench::start(MockSettings::new(Joint::EncoderShaft, 4)).unwrap();
    let bench = mock.open_bench("encoder bench").unwrap();
    (mock, bench)
}

fn strokes(bench: &Bench) -> Plan {
    let short = json!({"top_speed_rad_s": 60.0, "speeds": 2, "repeats": 2, "dwell_s": 1.0});
    procedure("encoder_delay").unwrap().plan(short.as_object().unwrap(), &BenchFacts::of(bench)).unwrap()
}

/// Notes about the motor's own encoder and the encoder under test.
fn notes_of_shaft(bench: &mut Bench, plan: &Plan) -> [String; 2] {
    let (_held, controls) = channel();
    let mut notes = Notes::default();
    let end = run(bench, plan, 1, &controls, &mut notes);
    assert_eq!(end.state, RunState::Completed, "{:?}", end.reason);
    ["Skew of the motor's own encoder", "Skew of the encoder under test"].map(|about| {
        notes
            .0
            .iter()
            .find(|note| note.starts_with(about))
            .cloned()
            .unwrap_or_else(|| panic!("{notes:?}", notes = notes.0))
    })
}

/// The lag of a note and the half width of its interval [s].
fn lag(note: &str) -> [f64; 2] {
    let (_, notes_of_shaft) = note.split_once("by a further ").unwrap_or_else(|| panic!("{note}"));
    let mut words = notes_of_shaft.split(' ');
    let mut figure = || 1e-3 * words.next().unwrap().parse::<f64>().unwrap();
    let size_s = figure();
    let way = if note.contains("it leads by") { -1.0 } else { 1.0 };
    [way * size_s, notes_of_shaft.split(' ').nth(2).unwrap().parse::<f64>().unwrap() * 1e-3]
}

#[test]
fn clock_and_values_agree_but_for_the_delay_of_the_encoder_under_test() {
    let (mock, mut bench) = start();
    let plan = strokes(&bench);
    let [motor, test] = notes_of_shaft(&mut bench, &plan);
    assert!(motor.contains("Time stamps and signals agree"), "{motor}");
    let [lag_s, reach_s] = lag(&test);
    let truth_s = mock.truth().encoders.delay_s;
    assert!((lag_s - truth_s).abs() <= reach_s && reach_s < 0.2 * truth_s, "{truth_s} s: {test}");
    assert!(test.contains("delay of this encoder"), "{test}");
}

/// A counter behind a buffer that always holds one reply back, with a clock that does not include it.
struct Buffered {
    counter: Box<dyn PositionCounter>,
    held: Option<Radians>,
}

impl Instrument for Buffered {
    fn name(&self) -> &str {
        self.counter.name()
    }

    fn port(&self) -> &str {
        self.counter.port()
    }

    fn identify(&mut self) -> Result<Identity, Fault> {
        self.counter.identify()
    }

    fn recover(&mut self) -> Result<Identity, Fault> {
        self.counter.recover()
    }

    fn record(&mut self, file: Option<&Path>) -> Result<(), Fault> {
        self.counter.record(file)
    }
}

impl PositionCounter for Buffered {
    fn zero(&mut self) -> Result<(), Fault> {
        self.counter.zero()
    }

    fn seek_index(&mut self) -> Result<bool, Fault> {
        self.counter.seek_index()
    }

    fn read(&mut self) -> Result<CounterReading, Fault> {
        let reading = self.counter.read()?;
        let position = self.held.replace(reading.position).unwrap_or(reading.position);
        Ok(CounterReading { position, ..reading })
    }

    fn resolution(&self) -> Radians {
        self.counter.resolution()
    }

    fn status(&mut self) -> Option<&mut dyn EncoderStatus> {
        self.counter.status()
    }
}

#[test]
fn a_delay_that_no_clock_knows_contradicts_it() {
    let (_mock, mut bench) = start();
    let counter = bench.reference_encoder.take().unwrap();
    bench.reference_encoder = Some(Box::new(Buffered { counter, held: None }));
    let plan = strokes(&bench);
    let [motor, _] = notes_of_shaft(&mut bench, &plan);
    let [lag_s, reach_s] = lag(&motor);
    // The reading of a drive may be one period of its control loop old.
    let held_s = -1.0 / plan.rate_hz;
    assert!((lag_s - held_s).abs() <= reach_s + 125e-6 && reach_s < 0.1e-3, "{held_s} s: {motor}");
    assert!(motor.contains("Unrecorded latency"), "{motor}");
}

#[test]
fn without_motion_no_lag_is_reported() {
    let (_mock, mut bench) = start();
    let mut plan = strokes(&bench);
    plan.steps.iter_mut().for_each(|step| step.velocity = Profile::from(0.0).hold(0.5));
    for note in notes_of_shaft(&mut bench, &plan) {
        assert!(note.contains("do not determine it"), "{note}");
    }
}
