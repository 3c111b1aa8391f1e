//! Effects of a stop and of an abort of the mock bench on its brake, and their reports.

use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::Bench;
use jointbench_instrument::units::{Amperes, RadPerSec};
use jointbench_procedure::{
    BenchFacts, Commit, Control, Demand, EventKind, Live, Recorder, RecorderFault, RunState, Safe, procedure, run,
};
use serde_json::json;
use std::f64::consts::TAU;
use std::sync::mpsc::{Sender, channel};

/// Time at which the joint turns at its top speed against 80 % of the brake's rating.
const AT_S: f64 = 91.7;
/// Poles in one turn of the brake's rotor.
const POLES: f64 = 21.0;

struct Steered {
    controls: Sender<Demand>,
    asks: Option<Control>,
    notes: Vec<String>,
}

impl Recorder for Steered {
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        Ok(None)
    }

    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault> {
        let note = |kind: &EventKind| match kind {
            EventKind::Note { text } => Some(text.clone()),
            _ => None,
        };
        self.notes.extend(commit.events.iter().filter_map(|event| note(&event.kind)));
        Ok(())
    }

    fn live(&mut self, live: Live<'_>) {
        if live.progress.elapsed_s >= AT_S
            && let Some(control) = self.asks.take()
        {
            self.controls.send(control.into()).unwrap();
        }
    }
}

/// Amplitude of the link torque over the brake's poles in a turn without current [Nm].
fn cogging_nm(bench: &mut Bench) -> f64 {
    let (link_rad_s, ratio, clock) = (1.0, bench.constants.gear_ratio, bench.clock.clone());
    bench.joint.arm(RadPerSec(2.0 * link_rad_s * ratio), Amperes(5.0)).unwrap();
    let turning_s = clock.now_s() + 1.0;
    let (mut at_s, mut rows, mut waves) = (turning_s - 1.0, 0.0, [0.0; 2]);
    while at_s < turning_s + TAU / link_rad_s {
        at_s += 0.004;
        bench.joint.set_velocity(RadPerSec(link_rad_s * ratio * (at_s - turning_s + 1.0).min(1.0))).unwrap();
        clock.sleep_until_s(at_s);
        let torque_nm = bench.torque_sensor.as_mut().unwrap().read().unwrap().0;
        if at_s > turning_s {
            let (sin, cos) = (POLES * bench.joint.read().unwrap().motor_position.0 / ratio).sin_cos();
            (rows, waves) = (rows + 1.0, [waves[0] + torque_nm * sin, waves[1] + torque_nm * cos]);
        }
    }
    bench.joint.disarm().unwrap();
    2.0 * waves[0].hypot(waves[1]) / rows
}

/// State at the end of the run, its notes, and the amplitude of the brake's cogging.
fn ended_by(control: Control) -> (RunState, Vec<String>, f64) {
    let mock = MockBench::start(MockSettings::new(Joint::JointA, 6)).unwrap();
    let mut bench = mock.open_bench("bench").unwrap();
    let choices = json!({ "load_levels": 2, "top_load": 0.8 });
    let plan = procedure("friction").unwrap().plan(choices.as_object().unwrap(), &BenchFacts::of(&bench)).unwrap();
    let (controls, receiver) = channel();
    let mut kept = Steered { controls, asks: Some(control), notes: Vec::new() };
    let end = run(&mut bench, &plan, 1, &receiver, &mut kept);
    assert_eq!(end.safe, Safe::SafeVerified);
    (end.state, kept.notes, cogging_nm(&mut bench))
}

#[test]
fn a_stop_unloads_the_brake_and_an_abort_reports_its_remanence() {
    let (state, notes, stopped_nm) = ended_by(Control::Stop);
    assert_eq!(state, RunState::Stopped);
    assert!(!notes.iter().any(|note| note.contains("Demagnetise")), "{notes:?}");

    let (state, notes, aborted_nm) = ended_by(Control::Abort);
    assert_eq!(state, RunState::Aborted);
    // The current that magnetised the rotor, not the remaining current at the next reading.
    assert!(notes.iter().any(|note| note.contains("fell from 0.480 A with the drive off. Demagnetise")), "{notes:?}");
    assert!(stopped_nm < 0.05 * aborted_nm && aborted_nm > 0.5, "{stopped_nm} and {aborted_nm} Nm");
}
