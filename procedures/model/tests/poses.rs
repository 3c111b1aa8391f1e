//! An encoder on a stage: its pose is an axis, and runs at two poses are no repeats of each other.

use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, diagnose, fit, maps};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Scatter of the rows [rad].
const NOISE_RAD: f64 = 3e-5;

/// Four poses, two turns in each direction at each, twice: one wave in a turn grows with the radial shift. The stage
/// never tilts.
fn placed() -> RunTable {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
    let names = [
        "time_s",
        "reference_position_rad",
        "test_position_rad",
        "velocity_rad_s",
        "stage_radial_m",
        "stage_tilt_rad",
        "segment",
        "repeat",
    ];
    let mut trace = Trace::new(names.map(Channel::new).into());
    let (mut row, mut angle) = (0.0, 0.0);
    for leg in 0..16 {
        let (radial_m, speed) = (1e-4 * f64::from(leg / 2 % 4), if leg % 2 == 0 { 6.0 } else { -6.0 });
        for _ in 0..500 {
            row += 1.0;
            angle += 0.004 * speed;
            let test = angle + 4.0 * radial_m * f64::sin(angle) + NOISE_RAD * normal();
            let (segment, repeat) = (f64::from(leg), f64::from(leg / 2));
            trace.push_row(&[0.004 * row, angle, test, speed, radial_m, 0.0, segment, repeat]);
        }
    }
    RunTable::new(Meta { kind: Some(Kind::Encoder), ..Meta::default() }, trace).unwrap()
}

#[test]
fn the_pose_of_the_stage_is_an_axis_and_no_noise() {
    let (run, options) = (placed(), Options::default());
    let spec = ModelSpec::new(Kind::Encoder, ["offset", "delay"]).unwrap();
    let found = diagnose(&run, &spec, &options).unwrap();
    assert!(found.noise_floor_rms.is_some_and(|rms| rms < 1.5 * NOISE_RAD), "{:?}", found.noise_floor);

    let drawn = maps(&run, &fit(&run, &spec, &options).unwrap(), &options).unwrap();
    let unit = |axis: &str| drawn.axes.iter().find(|map| map.axis == axis).map(|map| map.unit.as_str());
    assert_eq!((unit("stage_radial_m"), unit("stage_tilt_rad")), (Some("m"), None));
}
