//! A Stribeck curve with Coulomb and viscous friction: six parameters, two of them nonlinear.

use crate::{least_s, line, peer};
use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use jointbench_model::preprocess::prepare;
use jointbench_model::{Fit, ModelSpec, Options, fit, fit_prepared};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const TORQUE_CONSTANT: f64 = 0.08;
const EFFECTS: [&str; 4] = ["direction_offset", "coulomb", "viscous", "stribeck"];
const NAMES: [&str; 6] = ["tau_0", "tau_c", "c_v", "tau_s", "omega_s", "delta"];

pub fn measure(rows: usize) {
    let columns = columns(rows);
    let torque: Vec<f64> = columns[3].iter().map(|i| TORQUE_CONSTANT * i).collect();
    let scipy = peer::ask("stribeck", &[&columns[2], &torque]);
    let run = table(columns);
    let spec = ModelSpec::new(Kind::Friction, EFFECTS).expect("the library has these");
    let (here_s, found) = least_s(15, || fit(&run, &spec, &Options::default()).expect("the run can be fitted"));
    let prepared = prepare(&run, &Options::default()).expect("the run can be prepared");
    let (search_s, _) = least_s(15, || fit_prepared(&prepared, &spec, &Options::default()).expect("as before"));
    for (name, there) in NAMES.iter().zip(scipy.iter().flat_map(|(_, answer)| answer)) {
        let here = value(&found, name);
        assert!((here / there - 1.0).abs() < 0.02, "{name}: {here} here, {there} there");
    }
    let scipy_s = scipy.map(|b| b.0);
    let peer = "SciPy least_squares, analytic Jacobian, all rows";
    line(
        &format!("Stribeck fit with intervals from {rows} rows: steps averaged, then fitted"),
        here_s,
        peer,
        scipy_s,
        15.0,
    );
    line("the same of a run that is averaged already", search_s, peer, scipy_s, 15.0);
}

fn value(fit: &Fit, name: &str) -> f64 {
    fit.parameters.iter().find(|p| p.name == name).expect("every effect is visible").value
}

/// Steps of nine speeds in both directions, 250 samples each.
fn columns(rows: usize) -> Vec<Vec<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
    let mut columns = vec![Vec::new(); 6];
    let mut angle = 0.0;
    for row in 0..rows {
        let segment = row / 250;
        let (step, side) = (segment / 2, if segment.is_multiple_of(2) { 1.0 } else { -1.0 });
        let speed = 2.5 * 1.6f64.powi((step % 9) as i32);
        angle += side * speed * 0.004;
        let friction = 0.03 + 0.02 * (-(speed / 8.0).powf(1.4)).exp() + 1.5e-4 * speed;
        let torque = 0.002 + side * friction + 2e-3 * noise();
        let velocity = side * speed + 1e-3 * noise();
        let values =
            [row as f64 * 0.004, angle, velocity, torque / TORQUE_CONSTANT, segment as f64, (segment / 18) as f64];
        columns.iter_mut().zip(values).for_each(|(c, v)| c.push(v));
    }
    columns
}

fn table(columns: Vec<Vec<f64>>) -> RunTable {
    let names = ["time_s", "motor_position_rad", "motor_velocity_rad_s", "motor_current_a", "segment", "repeat"];
    let meta = Meta {
        kind: Some(Kind::Friction),
        torque_constant_nm_per_a: Some(TORQUE_CONSTANT),
        gear_ratio: Some(60.0),
        ..Meta::default()
    };
    RunTable::new(meta, Trace::from_columns(names.map(Channel::new).to_vec(), columns)).expect("a valid table")
}
