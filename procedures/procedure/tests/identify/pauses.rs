//! A run that is paused in a step of every kind, or killed and continued, gives the result of an uninterrupted one.

use super::cut::cut_anywhere;
use jointbench_devices::sim::Load;
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::{Bench, RunTable, Trace};
use jointbench_procedure::catalogue::brake_model;
use jointbench_procedure::in_memory_run::{run_in_memory, run_in_memory_with_facts};
use jointbench_procedure::parameter::Values;
use jointbench_procedure::plan::{Drive, Phase, Step};
use jointbench_procedure::resume::{Continuation, FinishedSteps, joined};
use jointbench_procedure::stage_pose::StagePose;
use jointbench_procedure::*;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{park, spawn};

/// Steps, time after their start [s], and the control at that time. `None`: the process is killed.
type Due = BTreeMap<usize, (f64, Option<Control>)>;

/// Rows, and their part of the plan.
type Acknowledged = (Option<Trace>, FinishedSteps);

/// Gives controls at some steps of a run, and resumes it soon after a pause.
struct Steer {
    controls: Sender<Demand>,
    due: Due,
    step: (usize, f64),
    waited: u32,
    rows: Option<Trace>,
    finished: FinishedSteps,
    continuation: Option<Continuation>,
    /// Receives the acknowledged data when the process is killed.
    killed: Sender<Acknowledged>,
}

impl Steer {
    fn new(plan: &Plan, due: Due) -> (Self, Receiver<Demand>, Receiver<Acknowledged>) {
        let ((controls, receiver), (killed, left)) = (channel(), channel());
        let continuation = Continuation::of(&plan.meta);
        let finished = FinishedSteps {
            steps: continuation.map_or(0, |continuation| continuation.from_step),
            ..FinishedSteps::default()
        };
        let step = (usize::MAX, 0.0);
        (Self { controls, due, step, waited: 0, rows: None, finished, continuation, killed }, receiver, left)
    }
}

impl Recorder for Steer {
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        Ok(None)
    }

    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault> {
        for event in commit.events {
            match event.kind {
                EventKind::StepStarted { step, segment, .. } => {
                    self.finished.add(self.continuation, step, segment, false)
                }
                EventKind::StepFinished { step, segment, .. } => {
                    self.finished.add(self.continuation, step, segment, true)
                }
                _ => {}
            }
        }
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
                self.controls.send(Control::Resume.into()).unwrap();
            }
        } else if self.due.get(&step).is_some_and(|(after_s, _)| elapsed_s - self.step.1 >= *after_s)
            && let Some((_, control)) = self.due.remove(&step)
        {
            match control {
                Some(control) => self.controls.send(control.into()).unwrap(),
                None => {
                    self.killed.send((self.rows.take(), self.finished.clone())).unwrap();
                    // The thread never acts again: no ramp, no securing.
                    loop {
                        park();
                    }
                }
            }
        }
    }
}

/// Runs a plan under these controls.
fn steered(bench: &mut Bench, plan: &Plan, due: Due) -> (RunEnd, RunTable, FinishedSteps) {
    let (mut steer, receiver, _left) = Steer::new(plan, due);
    let end = run(bench, plan, 1, &receiver, &mut steer);
    assert!(steer.due.is_empty(), "{}: not reached: {:?}", plan.procedure, steer.due);
    (end, RunTable::new(plan.meta.clone(), steer.rows.unwrap()).unwrap(), steer.finished)
}

/// Runs a plan until its process is killed; the instruments keep their state.
fn killed(mut bench: Bench, plan: &Plan, due: Due) -> (RunTable, FinishedSteps) {
    let (mut steer, receiver, left) = Steer::new(plan, due);
    let whole = plan.clone();
    spawn(move || run(&mut bench, &whole, 1, &receiver, &mut steer));
    let (rows, finished) = left.recv().unwrap();
    (RunTable::new(plan.meta.clone(), rows.unwrap()).unwrap(), finished)
}

/// The first step of every kind, and a time within it.
fn one_of_each_kind(plan: &Plan) -> Due {
    let mut kinds = BTreeMap::new();
    for (index, step) in plan.steps.iter().enumerate() {
        let way = step.velocity.knots().iter().map(|(_, v)| *v).find(|v| *v != 0.0).map(|v| v > 0.0);
        let (drive, place) = (std::mem::discriminant(&step.drive), std::mem::discriminant(&step.place));
        let braked = step.brake.largest() > 0.0;
        let (phase, before, control) = (step.phase, step.before, step.brake_control);
        let kind = format!("{phase:?} {before:?} {control:?} {drive:?} {place:?} {way:?} {braked}");
        // A current ramp ends with the breakaway, an edge search when the edge is found, so that both are left early.
        let within_s = match (&step.drive, step.place) {
            (Drive::Current { from_s, .. }, _) => from_s + 0.8,
            (_, StagePose::Edge(_)) => 1.0,
            _ => 0.5 * step.duration_s(),
        };
        kinds.entry(kind).or_insert((index, (within_s, Some(Control::Pause))));
    }
    kinds.into_values().collect()
}

/// Tracking errors follow the friction at the temperature of the run, which a pause changes: by this share of the error
/// without compensation.
const WARMTH: f64 = 0.02;

/// The torque of a brake follows its temperature too.
const BRAKE_WARMTH: f64 = 0.005;

/// What the temperature changes: a share of the figure of `compensation` without compensation, and of the torque of
/// `constant_load`, whose errors are in percent. 0 for another quantity.
fn warmth(found: &Identification, name: &str) -> f64 {
    let demanded_nm = found.quantity("demanded").map(|demanded| demanded.value);
    match (name.split('_').next(), demanded_nm) {
        (Some("reached"), Some(demanded_nm)) => BRAKE_WARMTH * demanded_nm,
        (Some("error"), Some(_)) => 100.0 * BRAKE_WARMTH,
        _ => WARMTH * without_compensation(found, name),
    }
}

fn without_compensation(found: &Identification, name: &str) -> f64 {
    let figure =
        ["rho_1_", "rho_2_", "rho_max_", "ratio_", "rms_", "shift_"].into_iter().find(|part| name.contains(part));
    let none = figure.and_then(|figure| {
        let (before, _) = name.split_once(figure)?;
        found.quantity(&format!("{before}{figure}none"))
    });
    none.map_or(0.0, |none| none.value.abs())
}

/// Both contain noise: the value may be outside the uninterrupted run's interval by half the width of the wider interval.
/// That of a mean over three rounds is sometimes narrow by chance.
fn same(what: &str, found: &Identification, unbroken: &Identification) {
    assert_eq!(found.verdict, unbroken.verdict, "{what}: {}", found.summary);
    for whole in &unbroken.quantities {
        let Some([low, high]) = whole.ci95 else { continue };
        let other = found.quantity(&whole.name).unwrap_or_else(|| panic!("{what}: no {}", whole.name));
        let half_width = other.ci95.map_or(0.0, |[low, high]| 0.5 * (high - low));
        let margin = half_width.max(0.5 * (high - low)) + warmth(unbroken, &whole.name);
        let holds = (low - margin..=high + margin).contains(&other.value);
        assert!(holds, "{what}, {}: {:e} beyond {low:e} … {high:e}", whole.name, other.value);
    }
}

fn check(settings: &MockSettings, id: &str, given: Value) {
    let (procedure, given): (&dyn Procedure, &Map<String, Value>) =
        (procedure(id).unwrap(), given.as_object().unwrap());
    let values = Values::parse(procedure.schema(), given).unwrap();
    let open = || {
        let mock = MockBench::start(settings.clone()).unwrap();
        let bench = mock.open_bench("mock").unwrap();
        (mock, bench)
    };
    let (_mock, mut bench) = open();
    let mut facts = BenchFacts::of(&bench);
    if procedure.brake_model(&values).is_some() {
        facts.brake_model = Some(measured_brake(&mut open().1));
    }
    let unbroken = run_in_memory_with_facts(&mut bench, &facts, procedure, given).unwrap().identification.unwrap();
    let finds = procedure.finds();
    for quantity in &unbroken.quantities {
        let is_declared = finds.iter().any(|findable| findable.is(&quantity.name) && findable.unit == quantity.unit);
        assert!(is_declared, "{id} does not say that it finds {} [{}]", quantity.name, quantity.unit);
    }

    let (_mock, mut bench) = open();
    let plan = procedure.plan(given, &facts).unwrap();
    let (end, table, _) = steered(&mut bench, &plan, one_of_each_kind(&plan));
    assert_eq!(end.state, RunState::Completed, "{id}: {:?}", end.reason);
    same(&format!("{id}, paused"), &procedure.identify(&values, &table).unwrap(), &unbroken);
    cut_anywhere(procedure, &values, &table);

    let measured = plan.steps.iter().filter(|step| step.phase == Phase::Measure).count();
    // A plan that is only a warm-up may end as soon as the joint is warm.
    let middle = if measured > 0 { plan.steps.len() - measured.div_ceil(2) } else { 1 };
    let within_s = 0.3_f64.min(0.5 * plan.steps[middle].duration_s());

    let (_mock, mut bench) = open();
    let (end, _, _) = steered(&mut bench, &plan, [(middle, (within_s, Some(Control::Abort)))].into());
    assert_eq!((end.state, end.safe), (RunState::Aborted, Safe::SafeVerified), "{id}: {:?}", end.reason);
    if procedure.can_resume().is_err() {
        return;
    }

    let (mock, bench) = open();
    let (first, finished) = killed(bench, &plan, [(middle, (within_s, None))].into());
    mock.orphan();
    let mut bench = mock.open_bench("mock").unwrap();
    let secured = secure(&mut bench);
    assert_eq!(secured.safe, Safe::SafeVerified, "{id}: {:?}", secured.notes);
    let rest = plan
        .remaining(1, finished.steps, finished.next_segment, &facts)
        .unwrap()
        .with_earlier_measurement(first.clone(), finished.clone());
    let (end, second, _) = steered(&mut bench, &rest, Due::new());
    assert_eq!(end.state, RunState::Completed, "{id}: {:?}", end.reason);
    let whole = joined(&first, &finished, &second, 0.0).unwrap();
    same(&format!("{id}, gone on with"), &procedure.identify(&values, &whole).unwrap(), &unbroken);
}

fn measured_brake(bench: &mut Bench) -> BrakeModel {
    let given = json!({"levels": 6, "loops": 1, "random_turns": 4, "dwell_s": 0.8, "speed_rad_s": 3.0});
    let hysteresis = procedure("brake_hysteresis").unwrap();
    brake_model(&run_in_memory(bench, hysteresis, given.as_object().unwrap()).unwrap().table).unwrap()
}

#[test]
fn an_arm_is_the_same_arm() {
    let given = json!({"speeds": 4, "repeats": 2, "breakaways": 3, "warm_up_s": 8.0, "ramp_nm_s": 0.03});
    check(&MockSettings::new(Joint::Puma, 2).hiding(&["stribeck"]), "puma_friction", given);
}

#[test]
fn a_joint_is_the_same_joint() {
    let joint = MockSettings::new(Joint::JointA, 1);
    for (id, given) in [
        ("friction", json!({"load_levels": 2, "fast_speeds": 3, "dwell_s": 0.6, "warm_up_s": 4.0})),
        ("friction_load", json!({"load_levels": 3, "speeds": 3, "warm_up_s": 4.0})),
        ("breakaway", json!({"positions": 3, "ramp_nm_s": 0.04})),
        ("presliding", json!({"amplitudes": 2, "swings": 1, "repeats": 2})),
        ("stiffness", json!({"load_levels": 4, "repeats": 2, "dwell_s": 0.8, "sample_rate_hz": 100.0})),
        ("strokes", json!({"repeats": 2, "dwell_s": 1.0, "speeds": 3, "sample_rate_hz": 100.0})),
        ("warm_up", json!({"longest_s": 70.0})),
        ("compensation", json!({"periods": 2, "period_s": 2.0})),
    ] {
        check(&joint, id, given);
    }
}

#[test]
fn a_campaign_is_the_same_campaign() {
    let given = json!({"heat_s": 0.0, "warm_up_s": 4.0, "load_levels": 3, "sample_rate_hz": 100.0});
    check(&MockSettings::new(Joint::JointA, 1), "identify_joint", given);
}

#[test]
fn a_brake_is_the_same_brake() {
    let joint = MockSettings::new(Joint::JointB, 3);
    for (id, given) in [
        ("brake_speed_independence", json!({"currents": 2, "speeds": 3, "dwell_s": 0.6})),
        ("brake_hysteresis", json!({"levels": 5, "loops": 2, "random_turns": 6, "dwell_s": 0.8, "speed_rad_s": 3.0})),
        ("brake_torque", json!({"histories": 2, "torques": 8, "speed_rad_s": 3.0})),
        ("constant_load", json!({"torque_nm": 6.0, "levels": 4, "speeds": 2, "repeats": 2, "top_speed_rad_s": 3.0})),
        ("demagnetise", json!({"turns": 1.0, "speed_rad_s": 3.0, "sample_rate_hz": 100.0})),
        ("brake_poles", json!({"repeats": 2, "speed_rad_s": 1.5, "demagnetise_speed_rad_s": 3.0})),
        ("torque_sensor_zero", json!({"duration_s": 45.0, "loads": 2, "speed_rad_s": 1.0, "dwell_s": 1.2})),
        ("friction_temperature", json!({"heat_s": 40.0, "cool_s": 40.0, "rest_s": 10.0})),
    ] {
        check(&joint, id, given);
    }
}

#[test]
fn a_transmission_is_the_same_transmission() {
    let joint = MockSettings { load: Load::GearAndBrakeB, ..MockSettings::new(Joint::JointA, 1) };
    check(&joint, "transmission_breakaway", json!({"positions": 3, "ramp_nm_s": 2.0}));
}

#[test]
fn an_encoder_is_the_same_encoder() {
    let shaft = MockSettings::new(Joint::EncoderShaft, 1);
    for (id, given) in [
        ("encoder_offset", json!({"repeats": 2})),
        ("encoder_delay", json!({})),
        ("encoder_linearity", json!({"turns": 4.0, "table_size": 256})),
        ("encoder_startup", json!({"power_ups": 4})),
        ("encoder_alignment", json!({"halvings": 2, "map_positions": 3, "map_turns": 2.0})),
    ] {
        check(&shaft, id, given);
    }
}

const SHORT: &str = r#"{"heat_s": 0.0, "warm_up_s": 4.0, "load_levels": 3, "periods": 2, "sample_rate_hz": 100.0}"#;

/// The compensation steps of a campaign, and the data of their planning.
fn campaign(settings: &MockSettings) -> (MockBench, Bench, Plan, BenchFacts) {
    let mock = MockBench::start(settings.clone()).unwrap();
    let bench = mock.open_bench("mock").unwrap();
    let facts = BenchFacts::of(&bench);
    let plan = procedure("identify_joint").unwrap().plan(&serde_json::from_str(SHORT).unwrap(), &facts).unwrap();
    (mock, bench, plan, facts)
}

#[test]
fn a_campaign_feeds_forward_the_friction_that_it_has_found() {
    let given: Map<String, Value> = serde_json::from_str(SHORT).unwrap();
    let values = Values::parse(procedure("identify_joint").unwrap().schema(), &given).unwrap();
    let identified = |table: &RunTable| procedure("identify_joint").unwrap().identify(&values, table).unwrap();
    // Not the friction that the plan expects of a joint.
    let (_mock, mut bench, plan, facts) = campaign(&MockSettings::new(Joint::JointB, 4).hiding(&["stribeck"]));
    let (end, table, _) = steered(&mut bench, &plan, Due::new());
    assert_eq!(end.state, RunState::Completed, "{:?}", end.reason);
    let unbroken = identified(&table);
    let value = |name: &str| unbroken.quantity(name).unwrap_or_else(|| panic!("no {name}")).value;
    assert!(value("compensation.ratio_full") < 0.5 && value("compensation.over_full") <= 0.0, "{}", unbroken.summary);
    let planned = procedure("identify_joint").unwrap().plan_deferred(&table, &facts).unwrap();
    let waits = plan.deferred.clone().unwrap().to;
    assert_eq!(planned.steps.iter().map(|step| step.segment).collect::<Vec<_>>(), waits.clone().collect::<Vec<_>>());
    let fed = |table: &RunTable| -> Vec<f64> {
        let (segment, fed_a) = (table.column("segment").unwrap(), table.column("motor_current_setpoint_a").unwrap());
        let largest =
            |of: u32| segment.iter().zip(fed_a).filter(|(s, _)| **s as u32 == of).map(|(_, a)| *a).fold(0.0, f64::max);
        planned.steps[1..5].iter().map(|step| largest(step.segment)).collect()
    };
    let tops = |steps: &[Step]| steps.iter().map(Step::top_motor_current_a).collect::<Vec<_>>();
    let (learnt_a, planned_a) = (tops(&planned.steps[1..5]), tops(&plan.steps[waits.start as usize + 1..][..4]));
    assert!(
        fed(&table).iter().zip(&learnt_a).all(|(fed_a, a)| (fed_a - a).abs() < 1e-3 * a),
        "{:?} {learnt_a:?}",
        fed(&table)
    );
    assert!(learnt_a.iter().zip(&planned_a).any(|(a, planned_a)| (a - planned_a).abs() > 1e-2 * a), "{planned_a:?}");

    // Killed long after the friction part: the continued run uses the friction of the first.
    let (mock, bench, plan, facts) = campaign(&MockSettings::new(Joint::JointB, 4).hiding(&["stribeck"]));
    let (first, finished) = killed(bench, &plan, [(waits.start as usize + 2, (1.0, None))].into());
    mock.orphan();
    let mut bench = mock.open_bench("mock").unwrap();
    assert_eq!(secure(&mut bench).safe, Safe::SafeVerified);
    let rest = plan
        .remaining(1, finished.steps, finished.next_segment, &facts)
        .unwrap()
        .with_earlier_measurement(first.clone(), finished.clone());
    let (end, second, _) = steered(&mut bench, &rest, Due::new());
    assert_eq!(end.state, RunState::Completed, "{:?}", end.reason);
    let whole = joined(&first, &finished, &second, 0.0).unwrap();
    assert_eq!(fed(&whole), fed(&table));
    same("gone on with in compensation", &identified(&whole), &unbroken);
}

#[test]
fn a_campaign_without_identified_friction_feeds_none_forward() {
    let settings = MockSettings::new(Joint::JointA, 1);
    let (_mock, mut bench, mut plan, _) = campaign(&settings);
    // Friction that was never measured.
    let deferred = plan.deferred.clone().unwrap();
    plan.steps.retain(|step| !deferred.from.contains(&step.segment));
    let (end, table, _) = steered(&mut bench, &plan, Due::new());
    assert_eq!(end.state, RunState::Completed, "{:?}", end.reason);
    let last = *table.column("segment").unwrap().last().unwrap() as u32;
    assert!(last < deferred.to.start, "compensation was made");
}
