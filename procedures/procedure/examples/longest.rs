//! How long the identification of the longest run takes: two hours at 1 kHz in twelve channels.
//!
//! ```text
//! cargo run --release -p jointbench-procedure --example longest
//! ```
//! A friction run of that length is written down row by row, with friction that has a Stribeck part and noise on the current.

use jointbench_instrument::bench::JointConstants;
use jointbench_instrument::{Channel, Limits, RunTable, Trace};
use jointbench_procedure::parameter::Values;
use jointbench_procedure::{BenchFacts, Plan, procedure};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::json;
use std::time::Instant;

const RATE_HZ: f64 = 1000.0;
const LONGEST_S: f64 = 7200.0;
const CHANNELS: [&str; 12] = [
    "time_s",
    "motor_position_rad",
    "motor_velocity_rad_s",
    "motor_current_a",
    "link_position_rad",
    "link_torque_nm",
    "temperature_c",
    "brake_current_a",
    "brake_torque_command_nm",
    "velocity_setpoint_rad_s",
    "segment",
    "repeat",
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let friction = procedure("friction").ok_or("no such procedure")?;
    let given = json!({"sample_rate_hz": RATE_HZ, "load_levels": 1, "repeats": 20, "dwell_s": 10.0});
    let given = given.as_object().ok_or("no choices")?;
    let plan = friction.plan(given, &facts())?;
    let table = measured(plan)?;
    let values = Values::parse(friction.schema(), given)?;
    let (rows, channels) = (table.len(), table.trace().channels().len());
    let began = Instant::now();
    let found = friction.identify(&values, &table).ok_or("no identification")?;
    let took_s = began.elapsed().as_secs_f64();
    println!("{rows} rows, {channels} channels: {took_s:.2} s\n{:?}: {}", found.verdict, found.summary);
    Ok(())
}

/// The plan's set-points, followed by a joint with τ_c 30 mNm, c_v 0.15 mNm·s/rad and a Stribeck rise of 9 mNm. The
/// steps are repeated until the time limit.
fn measured(plan: Plan) -> Result<RunTable, Box<dyn std::error::Error>> {
    let mut trace = Trace::new(CHANNELS.map(Channel::new).to_vec());
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let (km, gear) = (0.0406, 177.8);
    let (mut row, mut position_rad, mut segment) = (0_u64, 0.0, 0.0);
    while row as f64 / RATE_HZ < LONGEST_S {
        for step in &plan.steps {
            let ticks = (step.duration_s() * RATE_HZ) as u64;
            for tick in 0..ticks {
                let velocity = step.velocity.at(tick as f64 / RATE_HZ);
                position_rad += velocity / RATE_HZ;
                let stribeck = 0.009 * (-(velocity.abs() / 10.0).powf(0.8)).exp();
                let side = if velocity == 0.0 { 0.0 } else { velocity.signum() };
                let friction_nm = (0.030 + stribeck) * side + 1.5e-4 * velocity;
                let current_a = friction_nm / km + 0.02 * (rng.random_range(-1.0..1.0) + rng.random_range(-1.0..1.0));
                let time_s = row as f64 / RATE_HZ;
                let link_nm = 0.01 * side;
                trace.push_row(&[
                    time_s,
                    position_rad,
                    velocity,
                    current_a,
                    position_rad / gear,
                    link_nm,
                    40.0,
                    0.0,
                    0.0,
                    velocity,
                    segment,
                    f64::from(step.repeat),
                ]);
                row += 1;
            }
            segment += 1.0;
        }
    }
    Ok(RunTable::new(plan.meta, trace)?)
}

/// Joint A of docs/documents.md with brake A.
fn facts() -> BenchFacts {
    BenchFacts {
        name: "joint A".into(),
        simulated: true,
        limits: Limits {
            motor_velocity_rad_s: 250.0,
            motor_current_a: 10.0,
            link_torque_nm: 18.0,
            temperature_c: 80.0,
            brake_current_a: 0.6,
            brake_power_w: 350.0,
        },
        constants: JointConstants {
            torque_constant_nm_per_a: 0.0406,
            gear_ratio: 177.8,
            rotor_inertia_kg_m2: 1.0e-5,
            brake_compliance_v: 45.0,
            brake_rated_current_a: 0.6,
            brake_rated_torque_nm: 13.0,
            link_range_rad: None,
            load_gear_ratio: None,
        },
        has_torque_sensor: true,
        has_two_ranges: true,
        has_brake: true,
        encoder_counts: None,
        has_stage: false,
        amperes_per_volt: None,
        setpoint_interval: None,
        brake_model: None,
        compared_brake: None,
        feeds_forward: true,
    }
}
