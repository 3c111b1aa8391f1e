//! A brake in loops of different size: the torque at one current differs between them, so that they do not repeat
//! each other.

mod common;

use common::tables::{meta, scatter};
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{Discovery, ModelSpec, Options, Parameter, Verdict, diagnose, discover, fit};

/// Currents at which dry contacts slip [A].
const SLIPS: [f64; 12] = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6];
const STEP_A: f64 = 0.1;
/// Largest scatter of a sample to either side [Nm].
const SCATTER_NM: f64 = 0.01;

/// Drag of the bearings [Nm].
const DRAG_NM: f64 = 0.5;

/// Up and down in steps, to 1 A first and then to less, three times. `hold_nm` is the largest torque of each contact.
fn run(hold_nm: f64, can_absorb: bool) -> RunTable {
    recorded(hold_nm, can_absorb, 0)
}

/// The same without its first steps.
fn recorded(hold_nm: f64, can_absorb: bool, from: usize) -> RunTable {
    let names = ["time_s", "brake_current_a", "brake_torque_nm", "segment", "repeat"];
    let mut trace = Trace::new(names.map(Channel::new).to_vec());
    let levels = [10, 7, 4].into_iter().flat_map(|top: i32| (0..2 * top).map(move |step| top - (step - top).abs()));
    let levels: Vec<i32> = levels.collect();
    let mut states = [0.0f64; SLIPS.len()];
    let (mut before, mut at) = (0.0, 0);
    for (step, level) in levels.iter().cycle().take(3 * levels.len()).enumerate() {
        let level = f64::from(*level) * STEP_A;
        for _ in 0..100 {
            let current: f64 = before + (level - before) * 0.2;
            let pairs = states.iter_mut().zip(SLIPS);
            pairs.for_each(|(state, slips)| *state = (*state + current - before).clamp(-slips, slips));
            before = current;
            let held: f64 = states.iter().zip(SLIPS).map(|(state, slips)| hold_nm * state / slips).sum();
            let curve = if can_absorb { 5.0 * (current / 0.8).powi(3).tanh() } else { 6.0 * current };
            let torque = DRAG_NM + curve - held + 2.0 * SCATTER_NM * scatter(at, 1);
            let repeat = (step / levels.len()) as f64;
            if step >= from {
                trace.push_row(&[0.01 * at as f64, current, torque, step as f64, repeat]);
            }
            at += 1;
        }
    }
    RunTable::new(meta(Kind::Brake), trace).unwrap()
}

fn end(run: &RunTable, most: usize) -> Discovery {
    discover(run, &ModelSpec::baseline(run).unwrap(), &Options::default(), most).unwrap()
}

#[test]
fn a_current_is_no_number_of_waves() {
    let run = run(0.0, false);
    let found = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
    let hysteresis = found.silent.iter().find(|silent| silent.effect == "hysteresis");
    assert_eq!(hysteresis.map(|silent| &silent.sought), Some(&None), "{:?}", found.silent);
}

#[test]
fn the_floor_of_a_brake_holds_no_hysteresis() {
    for (hold_nm, can_absorb, expected) in [
        (0.0125, false, ["hysteresis"].as_slice()),
        (0.003, false, &["hysteresis"]),
        (0.0125, true, &["saturation", "hysteresis"]),
    ] {
        let run = run(hold_nm, can_absorb);
        let found = end(&run, 4);
        // With the hysteresis in the model and without.
        for found in [&found, &end(&run, 0)] {
            let floor = found.noise_floor_rms.unwrap();
            assert!(floor < 0.2 * SCATTER_NM, "{floor}: {}", found.summary);
        }
        let added: Vec<&String> = found.model[2..].iter().collect();
        assert!(
            added.len() == expected.len() && expected.iter().all(|e| added.iter().any(|a| a == e)),
            "{added:?} {}",
            found.summary
        );
        assert_eq!(found.verdict, Verdict::Adequate, "{}", found.summary);
    }
}

/// Its temperature hardly changes: multiplied by the torque, it would imitate curve and loops.
#[test]
fn a_warm_brake_has_its_loops_still() {
    let run = run(0.03, true);
    let column = |name| run.column(name).unwrap();
    let (mut channels, mut columns) = (run.trace().channels().to_vec(), run.trace().columns().to_vec());
    channels.push(Channel::new("temperature_c"));
    columns.push(column("time_s").iter().map(|t| 42.0 + 0.2 * (0.05 * t).sin()).collect());
    let run = RunTable::new(meta(Kind::Brake), Trace::from_columns(channels, columns)).unwrap();
    let found = end(&run, 4);
    let added: Vec<&str> = found.steps.iter().filter_map(|step| step.added.as_deref()).collect();
    assert!(found.fit.effects.len() == 4 && !added.contains(&"temperature_dependence"), "{added:?}: {}", found.summary);
}

fn drag(run: &RunTable) -> Parameter {
    let spec = ModelSpec::parse(Kind::Brake, "drag,torque_per_current,hysteresis").unwrap();
    let found = fit(run, &spec, &Options::default()).unwrap();
    found.parameters.into_iter().find(|p| p.effect == "drag").unwrap()
}

/// After a fall to zero current the iron has remanence, and only the time before any current separates it from the
/// drag.
#[test]
fn drag_with_hysteresis_is_reported_with_its_remanence() {
    for (from, word) in [(0, "before any current"), (20, "trades off with hysteresis")] {
        let found = drag(&recorded(0.0125, false, from));
        let [low, high] = found.ci95;
        assert!(low <= DRAG_NM + 0.04 && DRAG_NM <= high, "{found:?}");
        assert!(found.value > DRAG_NM + 0.1, "{found:?}");
        assert!(found.note.as_ref().is_some_and(|note| note.contains(word)), "{found:?}");
    }
}
