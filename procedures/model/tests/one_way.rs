//! A run in one direction: Coulomb friction and an offset are identical there, and so are cogging and friction
//! ripple.

mod common;

use common::tables::{meta, scatter};
use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, discover};

/// A direct drive that creeps over its teeth: three turns forwards, with small swings back.
fn creeping(baseline: &[&str]) -> RunTable {
    const STEP_S: f64 = 0.005;
    let mut trace = Trace::new(["time_s", "motor_position_rad", "motor_current_a"].map(Channel::new).to_vec());
    for i in 0..12_000 {
        let t = STEP_S * i as f64;
        let way = 0.3 * t + 1.2 * (0.1 * t).sin();
        let position = way + 0.1455 * (7.0 * way).sin();
        let torque = 0.03 + 0.02 * (7.0 * position).cos() + 2e-3 * scatter(i, 3);
        trace.push_row(&[t, position, torque / 0.08]);
    }
    let baseline = baseline.iter().map(|effect| (*effect).to_owned()).collect();
    RunTable::new(Meta { gear_ratio: Some(1.0), baseline, ..meta(Kind::Friction) }, trace).unwrap()
}

#[test]
fn a_run_in_one_direction_has_one_name_for_confounded_effects() {
    for baseline in [&["viscous"][..], &["coulomb", "viscous"]] {
        let run = creeping(baseline);
        let found = discover(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default(), 4).unwrap();
        let mut model: Vec<&str> = found.model.iter().map(String::as_str).filter(|e| *e != "viscous").collect();
        model.sort_unstable();
        assert_eq!(model, ["cogging", "coulomb"], "{}", found.summary);
        for (effect, other) in [("direction_offset", "coulomb"), ("friction_ripple", "cogging")] {
            let why = &found.not_visible.iter().find(|n| n.effect == effect).unwrap().why;
            assert!(why.contains("one direction only") && why.contains(other), "{effect}: {why}");
        }
        assert!(found.fit.notes.iter().any(|note| note.contains("one direction only")), "{:?}", found.fit.notes);
        let coulomb = found.fit.parameters.iter().find(|p| p.name == "tau_c").unwrap();
        assert!((coulomb.value - 0.03).abs() < 1e-3, "{coulomb:?}");
    }
}

/// Strokes in both directions, recorded one after the other with pauses between: in one recording each, or in several
/// pieces that each hold a part of a stroke.
#[test]
fn recordings_in_opposite_directions_are_not_one_direction() {
    const STEP_S: f64 = 0.005;
    for pieces in [1, 40] {
        let mut trace = Trace::new(["time_s", "motor_position_rad", "motor_current_a"].map(Channel::new).to_vec());
        let (rows, speeds) = (2_400, [3.0, -3.0, 6.0, -6.0]);
        let (mut position, mut pause_s) = (0.0, 0.0);
        for i in 0..speeds.len() * rows {
            let velocity = speeds[i / rows] * (1.0 + 0.5 * (0.004 * i as f64).sin());
            position += velocity * STEP_S;
            pause_s += if i % (rows / pieces) == 0 { 0.2 } else { 0.0 };
            let torque = 0.03 * velocity.signum() + 0.002 * velocity + 0.004 + 2e-4 * scatter(i, 3);
            trace.push_row(&[STEP_S * i as f64 + pause_s, position, torque / 0.08]);
        }
        let baseline = ["coulomb", "viscous"].map(String::from).to_vec();
        let run = RunTable::new(Meta { gear_ratio: Some(1.0), baseline, ..meta(Kind::Friction) }, trace).unwrap();
        let found = discover(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default(), 4).unwrap();
        assert_eq!(found.model, ["coulomb", "viscous", "direction_offset"], "{pieces} pieces: {}", found.summary);
        let coulomb = found.fit.parameters.iter().find(|p| p.name == "tau_c").unwrap();
        assert!((coulomb.value - 0.03).abs() < 1e-3, "{pieces} pieces: {coulomb:?}");
    }
}

/// In one direction the two forms of quadratic drag differ only in their sign.
#[test]
fn drag_in_one_direction_has_its_usual_form() {
    const STEP_S: f64 = 0.01;
    let mut trace = Trace::new(["time_s", "motor_position_rad", "motor_current_a"].map(Channel::new).to_vec());
    let mut position = 0.0;
    for i in 0..12_000 {
        let velocity: f64 = -30.0 - 20.0 * (0.004 * f64::from(i)).sin() - 5.0 * (0.013 * f64::from(i)).sin();
        position += velocity * STEP_S;
        let torque = -0.03 + 0.002 * velocity - 2e-5 * velocity * velocity + 2e-4 * scatter(i as usize, 3);
        trace.push_row(&[STEP_S * f64::from(i), position, torque / 0.08]);
    }
    let baseline = ["coulomb", "viscous"].map(String::from).to_vec();
    let run = RunTable::new(Meta { gear_ratio: Some(1.0), baseline, ..meta(Kind::Friction) }, trace).unwrap();
    let found = discover(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default(), 4).unwrap();
    let drag = found.fit.parameters.iter().find(|p| p.effect == "viscous_quadratic").expect(&found.summary);
    assert_eq!(drag.name, "c_2");
    assert!((drag.value - 2e-5).abs() < 2e-6, "{drag:?}");
}
