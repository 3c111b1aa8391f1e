//! Legs that differ by chance: a step in time has to exceed that.

use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use jointbench_model::{Diagnosis, Discovery, ModelSpec, Options, Verdict, diagnose, discover};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Four legs of an encoder, two speeds in both directions. Each leg has an offset of about 5 µrad, a sixth of the
/// scatter of a reading. From the third leg on all are shifted by `slip_rad`.
fn diagnosed(seed: u64, slip_rad: f64) -> Diagnosis {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
    let names = ["time_s", "reference_position_rad", "test_position_rad", "velocity_rad_s", "segment"];
    let mut trace = Trace::new(names.map(Channel::new).into());
    let (mut angle, mut row) = (0.2, 0.0);
    for (segment, speed) in [3.0, -3.0, 8.0, -8.0].into_iter().enumerate() {
        let apart = 5e-6 * normal() + if segment >= 2 { slip_rad } else { 0.0 };
        for _ in 0..1000 {
            row += 1.0;
            angle += 0.004 * speed;
            let test = angle - 2e-4 * speed + apart + 3e-5 * normal();
            trace.push_row(&[0.004 * row, angle, test, speed, segment as f64]);
        }
    }
    let run = RunTable::new(Meta { kind: Some(Kind::Encoder), ..Meta::default() }, trace).unwrap();
    diagnose(&run, &ModelSpec::new(Kind::Encoder, ["offset", "delay"]).unwrap(), &Options::default()).unwrap()
}

#[test]
fn four_legs_that_scatter_a_little_have_not_slipped() {
    // With sign flips of parts of legs, eight of fourteen such runs had a slip of about 10 µrad.
    let named: Vec<String> = (0..14)
        .filter_map(|seed| diagnosed(seed, 0.0).suggestions.into_iter().next())
        .map(|suggestion| suggestion.effect)
        .collect();
    assert!(named.len() <= 1, "{named:?}");
    let slipped = diagnosed(1, 4e-4);
    assert_eq!(slipped.suggestions.first().map(|s| s.effect.as_str()), Some("slip"), "{}", slipped.summary);
}

/// Three times up and down through the current of a brake that warms up, at two speeds. Each leg has an offset as
/// large as the scatter of a row, and the reading noise is correlated over a second.
fn braked(seed: u64) -> Discovery {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
    let names = "time_s brake_current_a brake_torque_nm velocity_rad_s position_rad temperature_c segment repeat";
    let mut trace = Trace::new(names.split(' ').map(Channel::new).collect());
    let (mut time, mut angle, mut slow) = (0.0, 0.0, 0.0);
    for leg in 0..12 {
        let (speed, apart) = ([2.0, 20.0][leg / 2 % 2], 0.007 * normal());
        for i in 0..400 {
            time += 0.02;
            angle += 0.02 * speed;
            let way = f64::from(i) / 400.0;
            let current = if leg % 2 == 0 { way } else { 1.0 - way };
            slow += -0.02 * slow + 0.002 * normal();
            let torque = 0.05 + 10.0 * current + apart + slow + 0.01 * normal();
            let warmth = 25.0 + 0.1 * time;
            trace.push_row(&[time, current, torque, speed, angle, warmth, leg as f64, (leg / 4) as f64]);
        }
    }
    let run = RunTable::new(Meta { kind: Some(Kind::Brake), ..Meta::default() }, trace).unwrap();
    let spec = ModelSpec::new(Kind::Brake, ["drag", "torque_per_current"]).unwrap();
    discover(&run, &spec, &Options::default(), 6).unwrap()
}

#[test]
fn what_whole_legs_scatter_by_is_neither_an_effect_nor_structure() {
    let found: Vec<Discovery> = (0..12).map(braked).collect();
    let wrong: Vec<String> = found
        .iter()
        .filter(|found| found.model.len() > 2 || found.verdict != Verdict::Adequate)
        .map(|found| format!("{:?}: {}", found.model, found.summary))
        .collect();
    assert!(wrong.len() <= 2, "{}: {wrong:#?}", wrong.len());
    assert!(found.iter().any(|found| found.summary.contains("the zero drifts by")));
}

/// Friction at eight speeds in both directions, six times. The offset of each leg differs from the previous one by
/// `step_nm` at random. All offsets drift by `drift_nm_s`, and half-way they jump by `leap_nm`.
fn wandered(seed: u64, step_nm: f64, drift_nm_s: f64, leap_nm: f64) -> (Vec<String>, Verdict) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
    let names = ["time_s", "motor_position_rad", "motor_velocity_rad_s", "motor_current_a", "segment", "repeat"];
    let mut trace = Trace::new(names.map(Channel::new).into());
    let (mut time, mut angle, mut zero) = (0.0, 0.0, 0.0);
    for leg in 0..96 {
        let velocity = [1.0, -1.0][leg % 2] * (1.0 + (leg / 2 % 8) as f64);
        zero += step_nm * normal() + if leg == 43 { leap_nm } else { 0.0 };
        for _ in 0..150 {
            time += 0.02;
            angle += 0.02 * velocity;
            let torque = 0.1 * velocity.signum() + 0.02 * velocity + zero + drift_nm_s * time + 0.004 * normal();
            trace.push_row(&[time, angle, velocity, torque, leg as f64, (leg / 16) as f64]);
        }
    }
    let meta = Meta { kind: Some(Kind::Friction), torque_constant_nm_per_a: Some(1.0), ..Meta::default() };
    let run = RunTable::new(meta, trace).unwrap();
    let spec = ModelSpec::new(Kind::Friction, ["coulomb", "viscous"]).unwrap();
    let found = discover(&run, &spec, &Options::default(), 6).unwrap();
    let named = found.model.into_iter().filter(|id| !["coulomb", "viscous"].contains(&id.as_str())).collect();
    (named, found.verdict)
}

#[test]
fn a_zero_that_wanders_is_no_effect_and_one_that_drifts_is() {
    // Correlated neighbouring legs counted as independent evidence, so that a drift or an offset was named.
    let found: Vec<(Vec<String>, Verdict)> = (0..12).map(|seed| wandered(seed, 0.0005, 0.0, 0.0)).collect();
    let named = found.iter().filter(|(named, _)| !named.is_empty()).count();
    let structure = found.iter().filter(|(_, verdict)| *verdict == Verdict::UnexplainedStructure).count();
    assert!(named <= 3, "{found:?}");
    // Nine runs if any significant part of an axis counts as structure; in the others some of it is common by chance.
    assert!(structure <= 5, "{found:?}");
    for seed in 0..3 {
        assert_eq!(wandered(seed, 0.0, 4e-5, 0.0).0, ["drift"]);
        let leapt = wandered(seed, 1e-4, 0.0, 0.01);
        assert_eq!(leapt.1, Verdict::UnexplainedStructure, "{leapt:?}");
    }
}
