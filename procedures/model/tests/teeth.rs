//! Slow steps over the teeth of a motor: their speed oscillates, and only they show the teeth.

mod common;

use common::tables::{meta, scatter};
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, Verdict, discover};

const STEP_S: f64 = 0.004;
/// Speeds of one repeat [rad/s]: teeth pass within a chunk at all but the first two.
const SPEEDS: [f64; 8] = [3.5, 5.0, 26.0, 52.0, 78.0, 104.0, 131.0, 157.0];
const TEETH: f64 = 12.0;
const INERTIA_KG_M2: f64 = 5e-5;

/// Steps in both directions, five times. The speed of the slowest two oscillates by a third.
fn run() -> RunTable {
    let names = ["time_s", "motor_position_rad", "motor_velocity_rad_s", "motor_current_a", "segment", "repeat"];
    let mut trace = Trace::new(names.map(Channel::new).into());
    let (mut angle, mut at) = (0.0f64, 0);
    for leg in 0..10 * SPEEDS.len() {
        let step = leg / 2 % SPEEDS.len();
        let speed = SPEEDS[step] * if leg % 2 == 0 { 1.0 } else { -1.0 };
        let wavers = if step < 2 { 0.33 } else { 0.0 };
        for _ in 0..300 {
            let velocity = speed * (1.0 + wavers * (TEETH * angle).sin());
            let acceleration = speed * wavers * TEETH * velocity * (TEETH * angle).cos();
            angle += velocity * STEP_S;
            let torque = 0.03 * velocity.signum()
                + 1e-4 * velocity
                + 0.008 * (TEETH * angle + 0.4).cos()
                + INERTIA_KG_M2 * acceleration
                + 0.004 * scatter(at, 3);
            let (segment, repeat) = (leg as f64, (leg / (2 * SPEEDS.len())) as f64);
            trace.push_row(&[at as f64 * STEP_S, angle, velocity, torque / 0.05, segment, repeat]);
            at += 1;
        }
    }
    let meta = jointbench_instrument::Meta { torque_constant_nm_per_a: Some(0.05), ..meta(Kind::Friction) };
    RunTable::new(meta, trace).unwrap()
}

#[test]
fn steps_that_waver_over_teeth_show_them() {
    let run = run();
    let spec = ModelSpec::parse(Kind::Friction, "inertia,coulomb,viscous").unwrap();
    let found = discover(&run, &spec, &Options::default(), 6).unwrap();
    assert_eq!(found.model, ["inertia", "coulomb", "viscous", "cogging"], "{}", found.summary);
    assert_eq!(found.verdict, Verdict::Adequate, "{}", found.summary);
    let order = found.fit.parameters.iter().find(|p| p.name == "harmonic").unwrap();
    assert_eq!(order.value, TEETH);
}
