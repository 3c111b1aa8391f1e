//! A wave over a part of a turn, in a run that is judged sample by sample: the run bounds the order only so far, and the
//! report says so.

mod common;

use common::tables::meta;
use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use jointbench_model::{Diagnosis, ModelSpec, Options, Parameter, ParameterState, diagnose};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// A direct drive that swings over this part of a turn, with so many waves of the torque in a turn.
fn swinging(turns: f64, waves: f64) -> Diagnosis {
    const STEP_S: f64 = 0.01;
    let mut trace = Trace::new(["time_s", "motor_position_rad", "motor_current_a"].map(Channel::new).to_vec());
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
    let phase = |t: f64| 0.5 * t + 0.8 * (0.13 * t).sin();
    for i in 0..12_000 {
        let t = STEP_S * i as f64;
        let position = turns * std::f64::consts::PI * phase(t).sin();
        let direction = phase(t).cos().signum();
        let torque = 0.03 * direction + 0.004 * (waves * position + 1.0).cos() + 0.02 * noise();
        trace.push_row(&[t, position, torque / 0.08]);
    }
    let baseline = ["inertia", "coulomb", "viscous"].map(String::from).to_vec();
    let run = RunTable::new(Meta { gear_ratio: Some(1.0), baseline, ..meta(Kind::Friction) }, trace).unwrap();
    diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap()
}

/// The order of the cogging that was found, and what is said of it.
fn order(found: &Diagnosis) -> (Parameter, String) {
    let cogging = found.suggestions.iter().find(|s| s.effect == "cogging").expect(&found.summary);
    let order = cogging.parameters.iter().find(|p| p.name == "harmonic").unwrap();
    (order.clone(), cogging.reasons.clone())
}

#[test]
fn less_than_a_turn_leaves_the_order_open() {
    let (part, said) = order(&swinging(0.45, 6.5));
    assert_eq!(part.state, ParameterState::Unidentified, "{part:?}");
    assert!(part.ci95[0] < part.ci95[1] && (part.ci95[0]..=part.ci95[1]).contains(&6.5), "{part:?}");
    assert!(said.contains("The number of waves is not identified by this run, which covers 0.45 of a turn"), "{said}");

    let (whole, said) = order(&swinging(1.1, 7.0));
    assert_eq!((whole.state, whole.ci95), (ParameterState::Ok, [7.0, 7.0]), "{whole:?}");
    assert!(!said.contains("number of waves"), "{said}");
}
