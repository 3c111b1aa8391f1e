//! The encoder bench's procedures on the mock bench, compared with its hidden truth.

use jointbench_devices::sim::{EncoderTruth, MockInstrument, PlannedTrouble, Trouble};
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::{Bench, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, fit};
use jointbench_procedure::identification::{Form, Identification, Mark, Verdict};
use jointbench_procedure::in_memory_run::{InMemoryRunFault, run_in_memory};
use jointbench_procedure::parameter::Values;
use jointbench_procedure::{
    BenchFacts, Commit, Control, Demand, EventKind, Live, Recorder, RecorderFault, RunState, Safe, procedure,
};
use serde_json::{Value, json};
use std::sync::mpsc::{Sender, channel};

fn open(seed: u64, filter: bool) -> (EncoderTruth, MockBench, Bench) {
    let mock = MockBench::start(MockSettings { filter, ..MockSettings::new(Joint::EncoderShaft, seed) }).unwrap();
    let bench = mock.open_bench("encoder bench").unwrap();
    (mock.truth().encoders, mock, bench)
}

fn run(bench: &mut Bench, id: &str, parameters: Value) -> Identification {
    let conducted = run_in_memory(bench, procedure(id).unwrap(), parameters.as_object().unwrap()).unwrap();
    let found = conducted.identification.unwrap();
    println!("{id}: {} in {:.0} s of the bench", found.summary, conducted.duration_s);
    let finds = procedure(id).unwrap().finds();
    for quantity in &found.quantities {
        println!("  {} = {:.6e} {} {:?}", quantity.name, quantity.value, quantity.unit, quantity.ci95);
        let is_declared = finds.iter().any(|findable| findable.is(&quantity.name) && findable.unit == quantity.unit);
        assert!(is_declared, "{id} does not say that it finds {} [{}]", quantity.name, quantity.unit);
    }
    assert_eq!(found.verdict, Verdict::Identified);
    found
}

/// The interval contains the truth, with a half width of at most `reach`.
fn check(found: &Identification, name: &str, truth: f64, reach: f64) {
    let quantity = found.quantity(name).unwrap_or_else(|| panic!("no {name}"));
    let [low, high] = quantity.ci95.unwrap();
    assert!((low..=high).contains(&truth), "{name}: {truth:e} is not in {low:e} to {high:e}");
    assert!(0.5 * (high - low) <= reach, "{name}: {low:e} to {high:e} is wider than ±{reach:e}");
}

/// Pauses at every third commit of a running run, and resumes soon after.
struct Pauser {
    controls: Sender<Demand>,
    commits: u32,
    pauses: u32,
    shown: u32,
    rows: Option<Trace>,
}

impl Recorder for Pauser {
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        Ok(None)
    }

    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault> {
        if commit.state == RunState::Running {
            self.commits += 1;
            if self.commits.is_multiple_of(3) && self.pauses < 4 {
                self.pauses += 1;
                self.controls.send(Control::Pause.into()).unwrap();
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
        self.shown += u32::from(live.state == RunState::Paused);
        if self.shown == 10 {
            self.shown = 0;
            self.controls.send(Control::Resume.into()).unwrap();
        }
    }
}

#[test]
fn a_hunt_that_is_paused_finds_the_same_edges() {
    let (truth, _mock, mut bench) = open(9, false);
    let alignment = procedure("encoder_alignment").unwrap();
    let given = json!({"halvings": 3, "map_positions": 3});
    let plan = alignment.plan(given.as_object().unwrap(), &BenchFacts::of(&bench)).unwrap();
    let (controls, receiver) = channel();
    let mut pauser = Pauser { controls, commits: 0, pauses: 0, shown: 0, rows: None };
    let end = jointbench_procedure::run(&mut bench, &plan, 1, &receiver, &mut pauser);
    assert_eq!((end.state, end.safe, pauser.pauses), (RunState::Completed, Safe::SafeVerified, 4), "{:?}", end.reason);
    let table = RunTable::new(plan.meta.clone(), pauser.rows.unwrap()).unwrap();
    let values = Values::parse(alignment.schema(), given.as_object().unwrap()).unwrap();
    let found = alignment.identify(&values, &table).unwrap();
    check(&found, "radial_negative", truth.radial_m[0], 4e-6);
    check(&found, "radial_positive", truth.radial_m[1], 4e-6);
    check(&found, "axial_positive", truth.axial_m, 8e-6);
    check(&found, "best_radial_shift", truth.best_radial_m, 3e-6);
}

/// Gives one control with the third commit of a running run.
struct Interrupter {
    controls: Sender<Demand>,
    control: Control,
    commits: u32,
    rows: u64,
}

impl Recorder for Interrupter {
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        Ok(None)
    }

    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault> {
        self.commits += u32::from(commit.state == RunState::Running);
        if self.commits == 3 {
            self.controls.send(self.control.into()).unwrap();
        }
        self.rows += commit.rows.len() as u64;
        Ok(())
    }

    fn live(&mut self, _live: Live<'_>) {}
}

#[test]
fn however_a_run_of_the_stage_is_ended_shaft_and_stage_stand_still() {
    for (control, state) in
        [(Control::Stop, RunState::Stopped), (Control::Abort, RunState::Aborted), (Control::EStop, RunState::Aborted)]
    {
        let (_, mock, mut bench) = open(11, false);
        let plan = procedure("encoder_alignment").unwrap().plan(&Default::default(), &BenchFacts::of(&bench)).unwrap();
        let (controls, receiver) = channel();
        let mut recorder = Interrupter { controls, control, commits: 0, rows: 0 };
        let end = jointbench_procedure::run(&mut bench, &plan, 1, &receiver, &mut recorder);
        assert_eq!((end.state, end.safe), (state, Safe::SafeVerified), "{control:?}: {:?}", end.reason);
        assert_eq!(end.rows, recorder.rows, "{control:?}");
        assert!(!bench.joint.health().unwrap().armed);
        let stage = bench.stage.as_mut().unwrap();
        let here = stage.pose().unwrap();
        let clock = mock.clock();
        clock.sleep_until_s(clock.now_s() + 1.0);
        let stage = bench.stage.as_mut().unwrap();
        let moved_m = (stage.pose().unwrap().shift_m[0] - here.shift_m[0]).abs();
        assert!(stage.is_referenced().unwrap() && moved_m < 1e-6, "{control:?}: {moved_m} m");
        // The next run can start.
        let offset = run_in_memory(&mut bench, procedure("encoder_offset").unwrap(), &Default::default()).unwrap();
        assert_eq!(offset.identification.unwrap().verdict, Verdict::Identified);
    }
}

#[test]
fn an_encoder_that_falls_silent_ends_the_run_and_the_bench_is_safe() {
    let silent =
        PlannedTrouble { instrument: MockInstrument::CounterS2, trouble: Trouble::Silent, from_s: 6.0, until_s: None };
    let settings =
        MockSettings { troubles: vec![silent], deadline_ms: 200, ..MockSettings::new(Joint::EncoderShaft, 1) };
    let mock = MockBench::start(settings).unwrap();
    let mut bench = mock.open_bench("encoder bench").unwrap();
    let offset = procedure("encoder_offset").unwrap();
    let Err(InMemoryRunFault::Ended { end, .. }) = run_in_memory(&mut bench, offset, json!({}).as_object().unwrap())
    else {
        panic!("the run came to its end without an encoder");
    };
    assert_eq!((end.state, end.safe), (RunState::Failed, Safe::SafeVerified), "{:?}", end.reason);
    assert!(end.reason.as_ref().unwrap().contains("s2"), "{:?}", end.reason);
    assert!(end.rows > 0);
}

#[test]
fn a_stage_that_lost_its_power_ends_the_run_too() {
    let lost = PlannedTrouble {
        instrument: MockInstrument::Stage,
        trouble: Trouble::PowerCycled,
        from_s: 15.0,
        until_s: Some(15.5),
    };
    let settings = MockSettings { troubles: vec![lost], deadline_ms: 200, ..MockSettings::new(Joint::EncoderShaft, 1) };
    let mock = MockBench::start(settings).unwrap();
    let mut bench = mock.open_bench("encoder bench").unwrap();
    let alignment = procedure("encoder_alignment").unwrap();
    let Err(InMemoryRunFault::Ended { end, .. }) = run_in_memory(&mut bench, alignment, json!({}).as_object().unwrap())
    else {
        panic!("the run came to its end with a stage that knows nothing");
    };
    assert_eq!((end.state, end.safe), (RunState::Failed, Safe::SafeVerified), "{:?}", end.reason);
    assert!(end.reason.as_ref().unwrap().contains("stage"), "{:?}", end.reason);
}

#[test]
fn every_power_up_moves_the_zero_and_the_bench_switches_by_itself() {
    let (truth, _mock, mut bench) = open(2, false);
    let found = run(&mut bench, "encoder_startup", json!({"power_ups": 10}));
    let [low, high] = found.quantity("startup_spread").unwrap().ci95.unwrap();
    assert!((low..=high).contains(&truth.startup_spread_rad), "{low:e} to {high:e}");
    let value = |name: &str| found.quantity(name).unwrap().value;
    assert!(value("repeatability") < 0.1 * value("startup_spread"), "{}", found.summary);
    // The joint is at the position of its reading, except for whole turns: offsets stay within the range of a
    // start-up.
    assert!(value("startup_range") < 60.5 * POINT_RAD, "{}", found.summary);
}

/// Switches the encoder off and on when the run requests it; the first time it only confirms.
struct Hand {
    mock: MockBench,
    controls: Sender<Demand>,
    asked: usize,
    rows: Option<Trace>,
}

impl Recorder for Hand {
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        Ok(None)
    }

    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault> {
        let waits = EventKind::State { state: RunState::Paused, reason: None };
        if commit.events.iter().any(|event| event.kind == waits) {
            self.asked += 1;
            if self.asked > 1 {
                self.mock.trouble(MockInstrument::CounterS2, Trouble::PowerCycled);
                self.mock.trouble(MockInstrument::CounterS2, Trouble::None);
            }
            self.controls.send(Control::Resume.into()).unwrap();
        }
        if !commit.rows.channels().is_empty() {
            match &mut self.rows {
                Some(rows) => rows.append(commit.rows),
                None => self.rows = Some(commit.rows),
            }
        }
        Ok(())
    }

    fn live(&mut self, _: Live<'_>) {}
}

#[test]
fn a_bench_without_a_switch_waits_for_a_hand_and_notices_when_it_did_nothing() {
    let (_, mock, bench) = open(4, false);
    let mut bench = Bench { power: None, ..bench };
    let startup = procedure("encoder_startup").unwrap();
    let given = json!({"power_ups": 3});
    let plan = startup.plan(given.as_object().unwrap(), &BenchFacts::of(&bench)).unwrap();
    let (controls, receiver) = channel();
    let mut hand = Hand { mock, controls, asked: 0, rows: None };
    let end = jointbench_procedure::run(&mut bench, &plan, 1, &receiver, &mut hand);
    assert_eq!((end.state, end.safe), (RunState::Completed, Safe::SafeVerified), "{:?}", end.reason);
    assert_eq!(hand.asked, 4, "once more than there are power-ups");
    let table = RunTable::new(plan.meta.clone(), hand.rows.unwrap()).unwrap();
    let values = Values::parse(startup.schema(), given.as_object().unwrap()).unwrap();
    let found = startup.identify(&values, &table).unwrap();
    assert_eq!(found.verdict, Verdict::Identified, "{}", found.summary);
}

const POINT_RAD: f64 = std::f64::consts::TAU / 262_144.0;

#[test]
fn the_dry_run_says_nothing_of_a_brake_where_there_is_none() {
    let (_, _mock, bench) = open(1, false);
    let facts = BenchFacts::of(&bench);
    let preview = procedure("encoder_offset").unwrap().plan(&Default::default(), &facts).unwrap().preview(&facts);
    let extremes = preview.extremes.iter().map(|one| one.quantity.as_str());
    let reported: Vec<_> = extremes.chain(preview.checks.iter().map(|one| one.name.as_str())).collect();
    assert!(reported.contains(&"motor velocity") && reported.contains(&"limits"), "{reported:?}");
    assert!(!reported.iter().any(|name| name.contains("brake") || name.contains("torque")), "{reported:?}");
}

#[test]
fn offset_and_delay_are_those_that_the_mock_was_given() {
    let (truth, _mock, mut bench) = open(3, false);
    let conducted = run_in_memory(&mut bench, procedure("encoder_offset").unwrap(), &Default::default()).unwrap();
    let offset = conducted.identification.unwrap();
    check(&offset, "offset", truth.offset_rad, POINT_RAD);
    let effects = ["offset", "harmonic_1", "harmonic_2", "delay"].map(String::from);
    let spec = ModelSpec::new(conducted.table.kind(), &effects).unwrap();
    let model = fit(&conducted.table, &spec, &Options::default()).unwrap();
    let reported = offset.summary.split("(truncated) it is ").nth(1).and_then(|rest| rest.split(' ').next());
    let stated_rad = 1e-3 * reported.unwrap().parse::<f64>().unwrap();
    assert!(
        (stated_rad - model.parameters[0].value).abs() < POINT_RAD,
        "{}: {}",
        offset.summary,
        model.parameters[0].value
    );
    let delay = run(&mut bench, "encoder_delay", json!({}));
    check(&delay, "delay", truth.delay_s, 1e-6);
    check(&delay, "hysteresis", truth.hysteresis_rad, 2.0 * POINT_RAD);
    // Table 4.2: three speeds in both directions; hysteresis belongs to the difference.
    for i in 1..=6 {
        let figure = |name: &str| delay.quantity(&format!("{name}_{i}")).unwrap();
        let (speed, disparity) = (figure("speed").value, figure("disparity"));
        let truth_rad = -truth.delay_s * speed - truth.hysteresis_rad * speed.signum();
        let [low, high] = disparity.ci95.unwrap();
        assert!((low..=high).contains(&truth_rad), "{low:e} … {high:e} for {truth_rad:e} at {speed} rad/s");
        assert_eq!(figure("delay").value, -disparity.value / speed);
        assert!((figure("disparity_points").value - disparity.value / POINT_RAD).abs() < 1e-9);
        check(&delay, &format!("delay_difference_{i}"), 0.0, 0.3e-6);
    }

    let without_s = delay.quantity("delay").unwrap().value;
    let (truth, _mock, mut bench) = open(3, true);
    let delay = run(&mut bench, "encoder_delay", json!({"delay_without_filter_s": without_s}));
    check(&delay, "delay", truth.delay_s, 1e-6);
    assert!((delay.quantity("filter_delay").unwrap().value - 10.99e-6).abs() < 0.3e-6);
    // Table 4.3: the filter delays by more than the 10 µs of its data sheet.
    for i in 1..=6 {
        check(&delay, &format!("missing_delay_{i}"), truth.filter_delay_s - 10e-6, 0.3e-6);
    }
}

#[test]
fn fifteen_bits_are_usable_behind_the_table() {
    let (truth, _mock, mut bench) = open(5, false);
    let found = run(&mut bench, "encoder_linearity", json!({}));
    let bits = |name: &str| found.quantity(name).unwrap().value;
    assert!((9.5..10.5).contains(&bits("bits_before")), "about 10 bits without a correction");
    assert!(bits("bits_velocity") > bits("bits_table"), "the fast turns show the delay");
    assert!(bits("bits_direction") >= 15.0);
    let before = found.quantity("bits_before").unwrap();
    let [low, high] = before.ci95.unwrap();
    assert!(low < before.value && before.value < high && high - low < 0.2, "{low} {high}");
    assert!(bits("bits_velocity") >= 15.0 || found.summary.contains("require the direction term"), "{}", found.summary);
    // Section 4.1.5: a table of 2^10 entries differs from the smoothed error by less than 1 bit in the mean.
    let [low, high] = found.quantity("table_error_mean_points").unwrap().ci95.unwrap();
    assert!(0.0 < low && high < 1.0, "{low} {high}");
    assert!(bits("table_error_max_points") > high);
    check(&found, "harmonic_1", truth.eccentricity_rad, 2.0 * POINT_RAD);
    check(&found, "harmonic_2", truth.tilt_rad, 2.0 * POINT_RAD);
    assert_eq!(found.quantity("pole_period_order").unwrap().value, truth.pole_pairs);
    assert!(found.summary.contains("pole pairs detected"), "{}", found.summary);

    let figure = |name: &str| found.figures.iter().find(|figure| figure.name == name).unwrap();
    let around = figure("polar");
    assert_eq!(around.form, Form::Polar);
    let reach = |label: &str| {
        let one = around.series.iter().find(|series| series.label == label).unwrap();
        assert_eq!(one.x.last(), Some(&(one.x[0] + std::f64::consts::TAU)), "{label} goes round");
        one.y.iter().fold(0.0, |most: f64, y| most.max(y.abs()))
    };
    for way in ["CCW", "CW"] {
        assert!(reach(&format!("{way}, after")) < 0.1 * reach(&format!("{way}, before")), "{way}");
    }
    let [before, after, noise] = &figure("harmonics").series[..] else { panic!("{:?}", figure("harmonics")) };
    assert!((before.band[0][0]..=before.band[0][1]).contains(&truth.eccentricity_rad), "{before:?}");
    // Harmonics 0, 1 and 4 of the pole pairs: the table removes them.
    for n in [0, 1, 4] {
        assert!(after.y[n] < 0.1 * before.y[n] && before.y[n] > noise.y[0], "{before:?} {after:?} {noise:?}");
    }
}

#[test]
fn every_edge_is_within_a_step_of_the_stage_and_the_best_place_is_found() {
    let (truth, mock, mut bench) = open(7, false);
    let found = run(&mut bench, "encoder_alignment", json!({}));
    check(&found, "radial_negative", truth.radial_m[0], 2e-6);
    check(&found, "radial_positive", truth.radial_m[1], 2e-6);
    check(&found, "axial_positive", truth.axial_m, 4e-6);
    check(&found, "rotation_negative", -truth.rotation_rad, 2e-4);
    check(&found, "rotation_positive", truth.rotation_rad, 2e-4);
    check(&found, "tilt_negative", -truth.lost_tilt_rad, 2e-4);
    check(&found, "tilt_positive", truth.lost_tilt_rad, 2e-4);
    assert!(found.quantity("vertical_negative").is_none() && found.quantity("vertical_positive").is_none());
    check(&found, "best_radial_shift", truth.best_radial_m, 2e-6);
    assert!(found.summary.starts_with("PASS"), "{}", found.summary);
    let [bars, unlost, tested, line] = &found.figures[0].series[..] else { panic!("{:?}", found.figures[0]) };
    assert!(bars.y.iter().all(|share| *share >= line.y[0]), "{bars:?}");
    assert_eq!((unlost.x.len(), &unlost.mark), (2, &Mark::Points), "vertically, both ways: {unlost:?}");
    assert!(tested.y[0] == tested.y[1] && tested.y[1] < bars.y[1], "the nearer radial limit: {tested:?}");
    // Table 4.4: the axis is consistent over the tested tolerance of the document, and lost at the nearer limit.
    check(&found, "tested_radial", -truth.radial_m[0], 2e-6);
    check(&found, "tested_axial", truth.axial_m, 4e-6);
    check(&found, "tested_rotation", truth.rotation_rad, 2e-4);
    check(&found, "tested_tilt", truth.lost_tilt_rad, 2e-4);
    let degree = std::f64::consts::TAU / 360.0;
    let shifts = [("radial", 0.2e-3), ("axial", 0.25e-3), ("vertical", 1e-3)];
    for (axis, at) in shifts.into_iter().chain([("rotation", 0.7 * degree), ("tilt", 0.1 * degree)]) {
        assert!(found.quantity(&format!("tested_{axis}")).unwrap().value >= at - 1e-9, "{axis}");
    }
    assert!(found.quantity("tested_vertical").unwrap().ci95.is_none(), "no limit within the travel");
    assert!((bars.band[0][0]..=bars.band[0][1]).contains(&(truth.radial_m[0].abs() / 0.15e-3)), "{bars:?}");

    let drawn = &found.figures[1].series;
    let (fitted, smallest) = (&drawn[2], &drawn[3]);
    let best_m = found.quantity("best_radial_shift").unwrap().value;
    assert!(smallest.x == [best_m] && fitted.y.iter().all(|error| *error >= smallest.y[0]), "{drawn:?}");

    // After the run the sensor is back at its position, and the best one is better.
    let at_m = bench.stage.as_mut().unwrap().pose().unwrap().shift_m[0];
    assert!(at_m.abs() < 1e-6, "{at_m} m");
    let next = procedure("encoder_alignment").unwrap().follow_up(&found).unwrap();
    let best = run(&mut bench, &next.procedure, next.parameters.into());
    assert!(best.quantity("harmonic_1").unwrap().value < 0.05 * truth.eccentricity_rad);
    run(&mut bench, &next.procedure, json!({"turns": 4.0}));
    let back_m = bench.stage.as_mut().unwrap().pose().unwrap().shift_m[0];
    assert!(back_m.abs() < 1e-6, "the sensor was taken back to 0, not to {back_m} m");
    drop(mock);
}
