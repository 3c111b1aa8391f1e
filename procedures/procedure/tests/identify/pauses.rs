//! An arm's run, paused in the middle of one step of every kind, says what an unbroken one says.

use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::{RunTable, Trace};
use jointbench_procedure::conduct::conduct;
use jointbench_procedure::parameter::Values;
use jointbench_procedure::plan::{Drive, Phase};
use jointbench_procedure::*;
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::mpsc::{Sender, channel};

/// Pauses once in each of some steps, and resumes soon after.
struct Pauser {
    controls: Sender<Control>,
    /// Steps, and how long after their start [s].
    due: BTreeMap<usize, f64>,
    step: (usize, f64),
    pauses: usize,
    waited: u32,
    rows: Option<Trace>,
}

impl Recorder for Pauser {
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        Ok(None)
    }

    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault> {
        if !commit.rows.channels().is_empty() {
            match &mut self.rows {
                Some(rows) => rows.append(commit.rows),
                None => self.rows = Some(commit.rows),
            }
        }
        Ok(())
    }

    fn live(&mut self, live: Live<'_>) {
        let Progress { step, elapsed_s, .. } = *live.progress;
        if self.step.0 != step {
            self.step = (step, elapsed_s);
        }
        if live.state == RunState::Paused {
            self.waited += 1;
            if self.waited.is_multiple_of(5) {
                self.controls.send(Control::Resume).unwrap();
            }
        } else if self.due.get(&step).is_some_and(|half_s| elapsed_s - self.step.1 >= *half_s) {
            self.due.remove(&step);
            self.pauses += 1;
            self.controls.send(Control::Pause).unwrap();
        }
    }
}

#[test]
fn an_arm_that_is_paused_in_every_kind_of_step_is_the_same_arm() {
    let given = json!({"speeds": 4, "repeats": 2, "breakaways": 3, "warm_up_s": 8.0, "ramp_nm_s": 0.03});
    let given = given.as_object().unwrap();
    let procedure = procedure("puma_friction").unwrap();
    let open = || {
        let mock = MockBench::start(MockSettings::new(Joint::Puma, 2).hiding(&["stribeck"])).unwrap();
        let bench = mock.open_bench("arm").unwrap();
        (mock, bench)
    };
    let (_mock, mut bench) = open();
    let unbroken = conduct(&mut bench, procedure, given).unwrap().identification.unwrap();

    let (_mock, mut bench) = open();
    let plan = procedure.plan(given, &BenchFacts::of(&bench)).unwrap();
    let mut kinds = BTreeMap::new();
    for (index, step) in plan.steps.iter().enumerate() {
        let way = step.velocity.knots().iter().map(|(_, v)| *v).find(|v| *v != 0.0).map(|v| v > 0.0);
        let kind = (step.phase == Phase::WarmUp, matches!(step.drive, Drive::Current { .. }), way);
        // A ramp of current ends where the joint breaks away: it is left early.
        let within_s = match step.drive {
            Drive::Current { from_s, .. } => from_s + 0.8,
            _ => 0.5 * step.duration_s(),
        };
        kinds.entry(kind).or_insert((index, within_s));
    }
    assert!(kinds.len() >= 6, "work-outs, lines and breakaways, each way: {kinds:?}");
    let (controls, heard) = channel();
    let due: BTreeMap<usize, f64> = kinds.into_values().collect();
    let count = due.len();
    let mut pauser = Pauser { controls, due, step: (usize::MAX, 0.0), pauses: 0, waited: 0, rows: None };
    let end = run(&mut bench, &plan, 1, &heard, &mut pauser);
    assert_eq!((end.state, pauser.pauses), (RunState::Completed, count), "{:?}", end.reason);
    let table = RunTable::new(plan.meta.clone(), pauser.rows.unwrap()).unwrap();
    let values = Values::parse(procedure.schema(), given).unwrap();
    let paused = procedure.identify(&values, &table).unwrap();
    for name in ["f_positive", "f_negative", "b_positive", "b_negative", "stiction_positive", "stiction_negative"] {
        let [value, whole] = [&paused, &unbroken].map(|found| found.quantity(name).unwrap());
        let [low, high] = whole.ci95.unwrap();
        assert!((low..=high).contains(&value.value), "{name}: {} beyond {low} … {high}", value.value);
    }
}
