//! Every bad day that strikes in mid-run, on the mock bench and through the drivers: the run ends in the right verdict, the
//! bench is safe, nothing is kept that was not measured, and once the trouble is over every port can be used again.

use jointbench_devices::sim::{MockInstrument, PlannedTrouble, Trouble};
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_procedure::{BenchFacts, Commit, Live, Recorder, RecorderFault, RunState, Safe, procedure, run, secure};
use std::sync::mpsc::channel;

/// In the first strokes, long before anything is finished.
const FROM_S: f64 = 8.0;
/// Slow quantities are asked for every half second: as long may rows follow whose quick ones are good.
const NOTICED_S: f64 = 0.6;

/// The times of the rows.
#[derive(Default)]
struct Kept(Vec<f64>);

impl Recorder for Kept {
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        Ok(None)
    }

    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault> {
        self.0.extend(commit.rows.column("time_s").unwrap_or_default());
        Ok(())
    }

    fn live(&mut self, _live: Live<'_>) {}
}

/// `named`: what the reason of the failure has to say. `safe`: what the run has to reach by itself.
fn check(instrument: MockInstrument, trouble: Trouble, named: &str, safe: &[Safe]) {
    let case = format!("{instrument:?}, {trouble:?}");
    let planned = PlannedTrouble { instrument, trouble, from_s: FROM_S, until_s: None };
    let settings = MockSettings { troubles: vec![planned], deadline_ms: 300, ..MockSettings::new(Joint::JointA, 6) };
    let mock = MockBench::start(settings).unwrap();
    let mut bench = mock.open_bench("bench").unwrap();
    let plan = procedure("friction").unwrap().plan(&Default::default(), &BenchFacts::of(&bench)).unwrap();
    let (_held, controls) = channel();
    let mut kept = Kept::default();
    let end = run(&mut bench, &plan, 1, &controls, &mut kept);

    let reason = end.reason.unwrap_or_default();
    assert_eq!(end.state, RunState::Failed, "{case}: {reason}");
    assert!(reason.contains(named), "{case}: {reason}");
    assert!(safe.contains(&end.safe), "{case}: {} after {reason}", end.safe);
    assert_eq!(end.rows, kept.0.len() as u64, "{case}");
    assert!(end.rows > 0 && kept.0.windows(2).all(|pair| pair[0] < pair[1]), "{case}");
    // A loose contact shows when the brake is to hold a current.
    let latest_s = if trouble == Trouble::CurrentLost { f64::INFINITY } else { FROM_S + NOTICED_S };
    assert!(kept.0.last().is_some_and(|last_s| *last_s <= latest_s), "{case}: {:?}", kept.0.last());

    mock.trouble(instrument, Trouble::None);
    bench.clock.sleep_until_s(bench.clock.now_s() + 3.0);
    // The first word of an instrument that lost its power is that it did.
    let _told = bench.joint.recover();
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

/// Side by side: nearly all of it is waiting for deadlines.
fn check_all(cases: impl IntoIterator<Item = (MockInstrument, Trouble, &'static str)>, safe: &[Safe]) {
    std::thread::scope(|scope| {
        for (instrument, trouble, named) in cases {
            scope.spawn(move || check(instrument, trouble, named, safe));
        }
    });
}

#[test]
fn without_its_torque_sensor_a_run_fails_and_the_bench_is_read_back_safe() {
    let others = [Trouble::Refusing, Trouble::Saturated];
    let sensor = |trouble| (MockInstrument::TorqueSensor, trouble, "torque_sensor");
    check_all(CABLE.into_iter().chain(others).map(sensor), &[Safe::SafeVerified]);
}

/// A joint that does not answer was told to stand down, and says so only when it is heard again.
#[test]
fn without_its_joint_a_run_fails_and_says_what_could_not_be_read_back() {
    let joint = |trouble| (MockInstrument::Joint, trouble, "joint");
    check_all(CABLE.into_iter().chain([Trouble::Refusing]).map(joint), &[Safe::SafeCommanded, Safe::UnsafeUnknown]);
}

#[test]
fn without_its_supply_a_run_fails_and_says_what_could_not_be_read_back() {
    let brake = |trouble| (MockInstrument::Brake, trouble, "brake_a");
    check_all(CABLE.into_iter().chain([Trouble::Refusing]).map(brake), &[Safe::SafeCommanded, Safe::UnsafeUnknown]);
}

#[test]
fn what_is_measured_and_must_not_be_ends_a_run_too() {
    let cases = [
        (MockInstrument::Joint, Trouble::OverTemperature, "temperature"),
        (MockInstrument::Brake, Trouble::CurrentLost, "does not hold"),
    ];
    check_all(cases, &[Safe::SafeVerified]);
}
