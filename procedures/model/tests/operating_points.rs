//! A table of operating points without a time: speed, load and current at steady state.

use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use jointbench_model::preprocess::prepare;
use jointbench_model::{ModelSpec, Options, Verdict, diagnose, discover};

const KM: f64 = 0.05;
const GEAR: f64 = 100.0;

/// Coulomb and viscous friction, a share of the load, and repeats that scatter by 0.2 %.
fn table(load_share: f64) -> RunTable {
    let mut noise = 7u64;
    let mut scatter = || {
        noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (noise >> 33) as f64 / f64::from(1u32 << 30) - 1.0
    };
    let (mut velocity, mut load, mut current) = (Vec::new(), Vec::new(), Vec::new());
    for _repeat in 0..3 {
        for torque_nm in [0.0, 5.0, 10.0] {
            for speed in [10.0, 20.0, 40.0, 80.0, 120.0, 160.0] {
                for way in [1.0, -1.0] {
                    let friction = 0.03 + 1e-4 * speed + load_share * torque_nm / GEAR;
                    velocity.push(way * speed);
                    load.push(way * torque_nm);
                    current.push(way * (friction + torque_nm / GEAR) * (1.0 + 2e-3 * scatter()) / KM);
                }
            }
        }
    }
    // Operating points at rest.
    for held in [0.3, -0.2, 0.1, 0.0, 0.4] {
        velocity.push(0.0);
        load.push(5.0);
        current.push(held);
    }
    let rows = velocity.len();
    let columns = [
        ("time_s", (0..rows).map(|row| row as f64).collect()),
        ("motor_position_rad", (0..rows).map(|row| row as f64).collect()),
        ("motor_current_a", current),
        ("motor_velocity_rad_s", velocity),
        ("link_torque_nm", load),
    ];
    let (names, columns): (Vec<&str>, Vec<Vec<f64>>) = columns.into_iter().unzip();
    let meta = Meta {
        kind: Some(Kind::Friction),
        baseline: ["coulomb", "viscous", "load_transmission"].map(String::from).to_vec(),
        operating_points: true,
        torque_constant_nm_per_a: Some(KM),
        gear_ratio: Some(GEAR),
        ..Meta::default()
    };
    RunTable::new(meta, Trace::from_columns(names.into_iter().map(Channel::new).collect(), columns)).unwrap()
}

#[test]
fn friction_under_load_is_missing_and_found() {
    let run = table(0.1);
    let spec = ModelSpec::baseline(&run).unwrap();
    let diagnosis = diagnose(&run, &spec, &Options::default()).unwrap();
    assert_eq!(diagnosis.suggestions[0].effect, "load_linear", "{}", diagnosis.summary);
    let found = discover(&run, &spec, &Options::default(), 3).unwrap();
    let size = found.fit.parameters.iter().find(|p| p.effect == "load_linear").unwrap();
    assert!((size.ci95[0]..size.ci95[1]).contains(&0.1), "{size:?}");
    assert_eq!(found.verdict, Verdict::Adequate, "{}", found.summary);
}

#[test]
fn nothing_is_named_where_nothing_is_missing_and_an_angle_is_not_testable() {
    let run = table(0.0);
    let diagnosis = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
    assert!(diagnosis.suggestions.is_empty() && diagnosis.verdict == Verdict::Adequate, "{}", diagnosis.summary);
    for effect in ["gravity", "cogging", "inertia", "presliding"] {
        assert!(diagnosis.not_visible.iter().any(|of| of.effect == effect), "{effect}: {:?}", diagnosis.not_visible);
    }
}

#[test]
fn each_point_in_motion_is_a_steady_state() {
    let run = table(0.1);
    let states = prepare(&run, &Options::default()).unwrap().steady_states();
    let speed = run.column("motor_velocity_rad_s").unwrap();
    let moving: Vec<_> = (0..run.len()).filter(|row| speed[*row] != 0.0).map(|row| row..row + 1).collect();
    assert_eq!(states.into_iter().map(|(_, rows)| rows).collect::<Vec<_>>(), moving);
}
