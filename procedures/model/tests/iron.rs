//! A torque constant that falls with the current like iron, not with a cube of the torque: no other effect is
//! missing.

mod common;

use common::tables::{meta, scatter};
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, diagnose};

const STEP_S: f64 = 0.004;
const RAMP: usize = 50;
const ROWS: usize = 250;
const REPEATS: usize = 2;
const SPEEDS_RAD_S: [f64; 8] = [2.0, 4.0, 7.0, 12.0, 20.0, 35.0, 60.0, 90.0];
const LOADS_NM: [f64; 4] = [0.0, 5.0, 10.0, 20.0];
const GEAR: f64 = 50.0;
const INERTIA_KG_M2: f64 = 2e-4;

/// Torque constant times current, with this relative loss at 0.65 Nm.
fn drawn_nm(torque_nm: f64, lost: f64) -> f64 {
    (0..60).fold(torque_nm, |drawn, _| torque_nm / (1.0 - lost * (drawn / 0.65).powi(2)))
}

fn run(lost: f64, seed: u64) -> RunTable {
    let names = "time_s motor_position_rad motor_velocity_rad_s motor_current_a link_torque_nm segment repeat";
    let mut trace = Trace::new(names.split(' ').map(Channel::new).collect());
    let ways = 2 * SPEEDS_RAD_S.len();
    let legs = ways * LOADS_NM.len();
    let mut angle = 0.0;
    for row in 0..REPEATS * legs * ROWS {
        let (leg, i) = (row / ROWS, row % ROWS);
        let way = if leg % 2 == 0 { 1.0 } else { -1.0 };
        let top = way * SPEEDS_RAD_S[leg % ways / 2];
        let ramp = top / (RAMP as f64 * STEP_S);
        let (share, acceleration) = match (i, ROWS - 1 - i) {
            (since, _) if since < RAMP => ((since as f64 + 0.5) / RAMP as f64, ramp),
            (_, until) if until < RAMP => ((until as f64 + 0.5) / RAMP as f64, -ramp),
            _ => (1.0, 0.0),
        };
        let (velocity, load) = (share * top, way * LOADS_NM[leg % legs / ways]);
        angle += velocity * STEP_S;
        let torque = load / GEAR + INERTIA_KG_M2 * acceleration + 0.1 * way + 1e-3 * velocity;
        let felt = drawn_nm(torque, lost) + 4e-3 * scatter(row, seed) + 4e-4 * scatter(leg, seed + 9);
        let (segment, repeat) = (leg as f64, (leg / legs) as f64);
        trace.push_row(&[row as f64 * STEP_S, angle, velocity, felt, load, segment, repeat]);
    }
    let mut meta = meta(Kind::Friction);
    meta.torque_constant_nm_per_a = Some(1.0);
    meta.gear_ratio = Some(GEAR);
    RunTable::new(meta, trace).unwrap()
}

#[test]
fn only_the_iron_is_named_for_any_curve() {
    for (lost, seed) in [(0.05, 1), (0.1, 2)] {
        let spec = ModelSpec::parse(Kind::Friction, "inertia,load_transmission,coulomb,viscous").unwrap();
        let found = diagnose(&run(lost, seed), &spec, &Options::default()).unwrap();
        let named: Vec<&str> = found.suggestions.iter().map(|s| s.effect.as_str()).collect();
        assert_eq!(named, ["torque_constant_saturation"], "{lost}: {}", found.summary);
    }
}
