//! The nonlinear fit compared with an established Levenberg–Marquardt implementation on the same points.

mod common;

use common::bench::Staircase;
use jointbench_model::{ModelSpec, Options, fit, residuals};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector, Dyn, Owned, U5, Vector5};

struct Stribeck {
    velocity: Vec<f64>,
    friction: Vec<f64>,
    p: Vector5<f64>,
}

impl Stribeck {
    fn model(&self, p: &Vector5<f64>) -> DVector<f64> {
        let of =
            |w: &f64| w.signum() * (p[0] + p[2] * (-(w.abs() / p[3].exp()).powf(p[4].exp())).exp()) + p[1] * 1e-3 * w;
        DVector::from_iterator(self.velocity.len(), self.velocity.iter().map(of))
    }
}

impl LeastSquaresProblem<f64, Dyn, U5> for Stribeck {
    type ParameterStorage = Owned<f64, U5>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, U5>;

    fn set_params(&mut self, p: &Vector5<f64>) {
        self.p = *p;
    }

    fn params(&self) -> Vector5<f64> {
        self.p
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(self.model(&self.p) - DVector::from_column_slice(&self.friction))
    }

    fn jacobian(&self) -> Option<nalgebra::OMatrix<f64, Dyn, U5>> {
        let mut jacobian = DMatrix::zeros(self.velocity.len(), 5);
        for k in 0..5 {
            let (mut up, mut down) = (self.p, self.p);
            up[k] += 1e-6;
            down[k] -= 1e-6;
            jacobian.set_column(k, &((self.model(&up) - self.model(&down)) / 2e-6));
        }
        Some(jacobian.fixed_columns::<5>(0).into_owned())
    }
}

#[test]
fn stribeck_ends_where_levenberg_marquardt_ends() {
    let truth = |w: f64| w.signum() * (0.03 + 0.015 * (-(w.abs() / 7.0).powf(1.4)).exp()) + 1.5e-4 * w;
    let run = Staircase { noise_nm: 1e-3, scatter_nm: 1e-4, seed: 11 }.run(|m| truth(m.velocity));
    let spec = ModelSpec::baseline(&run).unwrap().with("stribeck").unwrap();
    let own = fit(&run, &spec, &Options::default()).unwrap();
    let set = residuals(&run, &own, &Options::default()).unwrap();
    let axis = |name: &str| &set.axes.iter().find(|a| a.name == name).unwrap().values;
    let judged: Vec<usize> = (0..set.error.len()).filter(|i| !set.held_out[*i]).collect();
    let velocity = judged.iter().map(|i| axis("motor_velocity_rad_s")[*i]).collect();
    let load = axis("link_torque_nm");
    let friction = judged.iter().map(|i| set.measured[*i] - load[*i] / common::bench::GEAR).collect();
    let start = Vector5::new(0.025, 0.2, 0.01, 5.0f64.ln(), 1.0f64.ln());
    let (oracle, report) = LevenbergMarquardt::new().minimize(Stribeck { velocity, friction, p: start });
    assert!(report.termination.was_successful(), "{:?}", report.termination);
    let value = |name: &str| own.parameters.iter().find(|p| p.name == name).unwrap().value;
    let p = oracle.p;
    for (name, theirs) in
        [("tau_c", p[0]), ("c_v", p[1] * 1e-3), ("tau_s", p[2]), ("omega_s", p[3].exp()), ("delta", p[4].exp())]
    {
        assert!((value(name) / theirs - 1.0).abs() < 0.01, "{name}: {} and {theirs}", value(name));
    }
}
