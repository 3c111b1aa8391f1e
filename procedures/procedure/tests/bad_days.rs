//! Every fault during a run, on the mock bench and through the drivers: the run ends with the right verdict, and the
//! bench is safe. Nothing unmeasured is kept, and every port can be used again after the fault.

use jointbench_devices::sim::{MockInstrument, PlannedTrouble, Transport, Trouble};
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::{Bench, FaultKind};
use jointbench_procedure::{
    BenchFacts, Commit, EventKind, Live, Recorder, RecorderFault, RunEnd, RunState, Safe, procedure, run, secure,
};
use serde_json::json;
use std::sync::mpsc::channel;

/// In the first strokes, long before the end of the run.
const FROM_S: f64 = 8.0;
/// Time without a plug while another unit replaces an instrument: shorter than the deadline of the engine.
const PULLED_S: f64 = 0.05;
/// Slow quantities are read every half second, so that rows with good fast readings may continue for this time.
const NOTICED_S: f64 = 0.6;

/// The times of the rows, and the notes.
#[derive(Default)]
struct MemoryRecorder {
    times_s: Vec<f64>,
    events: Vec<EventKind>,
}

impl Recorder for MemoryRecorder {
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        Ok(None)
    }

    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault> {
        self.times_s.extend(commit.rows.column("time_s").unwrap_or_default());
        self.events.extend(commit.events.iter().map(|event| event.kind.clone()));
        Ok(())
    }

    fn live(&mut self, _live: Live<'_>) {}
}

/// `None`: for ever.
type Planned = (MockInstrument, Trouble, f64, Option<f64>);

fn start(troubles: impl IntoIterator<Item = Planned>) -> (MockBench, Bench) {
    let planned = |(instrument, trouble, from_s, until_s)| PlannedTrouble { instrument, trouble, from_s, until_s };
    let troubles = troubles.into_iter().map(planned).collect();
    let mock = MockBench::start(MockSettings { troubles, deadline_ms: 300, ..MockSettings::new(Joint::JointA, 6) });
    let mock = mock.unwrap();
    let bench = mock.open_bench("bench").unwrap();
    (mock, bench)
}

fn play(bench: &mut Bench, id: &str, parameters: serde_json::Value) -> (RunEnd, MemoryRecorder) {
    let parameters = parameters.as_object().cloned().unwrap_or_default();
    let plan = procedure(id).unwrap().plan(&parameters, &BenchFacts::of(bench)).unwrap();
    let (_held, controls) = channel();
    let mut kept = MemoryRecorder::default();
    let end = run(bench, &plan, 1, &controls, &mut kept);
    (end, kept)
}

/// `named`: required text in the reason of the failure. `safe`: required result of securing.
fn check(id: &str, instrument: MockInstrument, trouble: Trouble, named: &str, safe: &[Safe]) {
    let case = format!("{id}: {instrument:?}, {trouble:?}");
    // An instrument is only exchanged after its plug was pulled.
    let pulled = (instrument, Trouble::Unplugged, FROM_S, None);
    let troubles = match trouble {
        Trouble::Exchanged => vec![pulled, (instrument, trouble, FROM_S + PULLED_S, None)],
        _ => vec![(instrument, trouble, FROM_S, None)],
    };
    let (mock, mut bench) = start(troubles);
    let (end, MemoryRecorder { times_s, .. }) = play(&mut bench, id, serde_json::Value::Null);

    let reason = end.reason.unwrap_or_default();
    assert_eq!(end.state, RunState::Failed, "{case}: {reason}");
    assert!(reason.contains(named), "{case}: {reason}");
    assert!(safe.contains(&end.safe), "{case}: {} after {reason}", end.safe);
    assert_eq!(end.rows, times_s.len() as u64, "{case}");
    assert!(end.rows > 0 && times_s.windows(2).all(|pair| pair[0] < pair[1]), "{case}");
    // A loose contact shows when the brake has to hold a current; of gaps only many are a failure.
    let shows_with_delay = [Trouble::CurrentLost, Trouble::StreamGap].contains(&trouble);
    let latest_s = if shows_with_delay { f64::INFINITY } else { FROM_S + NOTICED_S };
    assert!(times_s.last().is_some_and(|last_s| *last_s <= latest_s), "{case}: {:?}", times_s.last());

    mock.trouble(instrument, Trouble::None);
    bench.clock.sleep_until_s(bench.clock.now_s() + 3.0);
    // The first reply of an instrument after a loss of power reports that loss.
    let _reply = bench.joint.recover();
    let secured = secure(&mut bench);
    assert_eq!(secured.safe, Safe::SafeVerified, "{case}: {:?}", secured.notes);
    assert!(!bench.joint.health().unwrap().armed, "{case}");
    bench.joint.read().unwrap();
    bench.torque_sensor.as_mut().unwrap().read().unwrap();
    bench.brake.as_mut().unwrap().read().unwrap();
}

const CABLE: [Trouble; 8] = [
    Trouble::Silent,
    Trouble::Late,
    Trouble::Garbled,
    Trouble::Truncated,
    Trouble::Doubled,
    Trouble::Stale,
    Trouble::Unplugged,
    Trouble::PowerCycled,
];

/// In parallel, because nearly all of the time is waiting for deadlines.
fn check_all(cases: impl IntoIterator<Item = (MockInstrument, Trouble, &'static str)>, safe: &[Safe]) {
    std::thread::scope(|scope| {
        for (instrument, trouble, named) in cases {
            scope.spawn(move || check("friction", instrument, trouble, named, safe));
        }
    });
}

#[test]
fn without_its_torque_sensor_a_run_fails_and_the_bench_is_read_back_safe() {
    let others = [Trouble::Refusing, Trouble::Saturated];
    let sensor = |trouble| (MockInstrument::TorqueSensor, trouble, "torque_sensor");
    check_all(CABLE.into_iter().chain(others).map(sensor), &[Safe::SafeVerified]);
}

/// A joint that does not answer was commanded to disarm, and confirms it when it is reachable again.
#[test]
fn without_its_joint_a_run_fails_and_reports_what_could_not_be_read_back() {
    let joint = |trouble| (MockInstrument::Joint, trouble, "joint");
    check_all(CABLE.into_iter().chain([Trouble::Refusing]).map(joint), &[Safe::SafeCommanded, Safe::UnsafeUnknown]);
}

#[test]
fn without_its_supply_a_run_fails_and_reports_what_could_not_be_read_back() {
    let brake = |trouble| (MockInstrument::Brake, trouble, "brake_a");
    check_all(CABLE.into_iter().chain([Trouble::Refusing]).map(brake), &[Safe::SafeCommanded, Safe::UnsafeUnknown]);
}

#[test]
fn what_is_measured_and_must_not_be_ends_a_run_too() {
    let cases = [
        (MockInstrument::Joint, Trouble::OverTemperature, "temperature"),
        (MockInstrument::Brake, Trouble::CurrentLost, "the supply does not reach"),
    ];
    check_all(cases, &[Safe::SafeVerified]);
}

#[test]
fn another_unit_in_the_place_of_an_instrument_is_named_as_one() {
    let exchanged = |instrument| (instrument, Trouble::Exchanged, "another instrument answers: expected");
    check_all([exchanged(MockInstrument::TorqueSensor)], &[Safe::SafeVerified]);
    let others = [MockInstrument::Joint, MockInstrument::Brake].map(exchanged);
    check_all(others, &[Safe::SafeCommanded, Safe::UnsafeUnknown]);
}

#[test]
fn another_unit_behind_a_port_that_was_never_lost_is_named_at_the_end() {
    for instrument in [MockInstrument::TorqueSensor, MockInstrument::Brake] {
        let short = json!({"load_levels": 3, "dwell_s": 0.5, "top_load": 0.3});
        let (_mock, mut bench) = start([(instrument, Trouble::Exchanged, FROM_S, None)]);
        let (end, MemoryRecorder { events, .. }) = play(&mut bench, "stiffness", short);
        let reason = end.reason.unwrap_or_default();
        assert_eq!(end.state, RunState::Failed, "{instrument:?}: {reason}");
        assert!(reason.contains("another instrument answers: expected"), "{instrument:?}: {reason}");
        let is_named = |event: &EventKind| match event {
            EventKind::Fault { fault, recovered: false } => fault.is_wrong_instrument(),
            _ => false,
        };
        assert!(events.iter().any(is_named), "{instrument:?}");
    }
}

#[test]
fn a_torque_stream_that_fails_ends_its_run_and_the_bench_is_read_back_safe() {
    std::thread::scope(|scope| {
        for trouble in CABLE.into_iter().chain([Trouble::StreamGap, Trouble::Saturated, Trouble::Exchanged]) {
            // Samples that arrive late in whole chunks have the right place by their index.
            if trouble == Trouble::Stale {
                continue;
            }
            let named = match trouble {
                Trouble::StreamGap => "8 samples missing from the stream",
                Trouble::Exchanged => "another instrument answers: expected",
                _ => "torque_sensor",
            };
            scope.spawn(move || {
                check("stiffness", MockInstrument::TorqueSensor, trouble, named, &[Safe::SafeVerified]);
            });
        }
    });
}

#[test]
fn a_gap_in_the_torque_stream_is_reported_and_not_filled() {
    let short = json!({"load_levels": 3, "dwell_s": 0.5, "top_load": 0.3});
    let gaps = (MockInstrument::TorqueSensor, Trouble::StreamGap, FROM_S, Some(FROM_S + 0.6));
    let (_mock, mut bench) = start([gaps]);
    let (end, MemoryRecorder { times_s, events }) = play(&mut bench, "stiffness", short);
    assert_eq!((end.state, end.safe), (RunState::Completed, Safe::SafeVerified), "{:?}", end.reason);
    let counts: Vec<u64> = events
        .iter()
        .filter_map(|event| match event {
            EventKind::Fault { fault, recovered: true } => match fault.kind {
                FaultKind::StreamGap { count } => Some(count),
                _ => None,
            },
            _ => None,
        })
        .collect();
    assert!(!counts.is_empty() && counts.iter().all(|count| *count == 8), "{counts:?}");
    let missing: u64 = counts.iter().sum();
    let reported = format!("{missing} torque samples are missing");
    assert!(events.iter().any(|event| matches!(event, EventKind::Warning { text } if text.contains(&reported))));
    // Eight samples are two rows at 250 Hz: these are missing, and the other rows are unchanged.
    let holes = times_s.windows(2).filter(|pair| (0.0061..0.1).contains(&(pair[1] - pair[0]))).count();
    assert_eq!(holes, counts.len());
}

#[test]
fn a_cable_that_is_back_under_another_port_serves_a_bench_that_is_opened_again() {
    let pulled = PlannedTrouble {
        instrument: MockInstrument::TorqueSensor,
        trouble: Trouble::Unplugged,
        from_s: FROM_S,
        until_s: None,
    };
    let (transport, deadline_ms) = (Transport::Terminal, 300);
    let settings =
        MockSettings { transport, troubles: vec![pulled], deadline_ms, ..MockSettings::new(Joint::JointA, 6) };
    let mock = MockBench::start(settings).unwrap();
    let mut bench = mock.open_bench("bench").unwrap();
    let (end, _) = play(&mut bench, "stiffness", serde_json::Value::Null);
    assert_eq!((end.state, end.safe), (RunState::Failed, Safe::SafeVerified), "{:?}", end.reason);
    assert!(end.reason.unwrap().contains("port lost"));
    drop(bench);
    mock.trouble(MockInstrument::TorqueSensor, Trouble::None);
    // Another thread plugs it in.
    let since = std::time::Instant::now();
    let mut again = loop {
        match mock.open_bench("again") {
            Ok(bench) => break bench,
            Err(fault) => assert!(since.elapsed().as_secs() < 10, "{fault}"),
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    };
    assert_eq!(secure(&mut again).safe, Safe::SafeVerified);
    again.torque_sensor.as_mut().unwrap().read().unwrap();
}
