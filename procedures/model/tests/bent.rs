//! A Stribeck effect with a free exponent imitates a quadratic speed term, at the cost of Coulomb friction.

mod common;

use common::tables::{friction_in_steps, scatter};
use jointbench_instrument::Kind;
use jointbench_model::{Discovery, ModelSpec, Options, Verdict, discover};

const SPEEDS_RAD_S: [f64; 11] = [2.4, 3.5, 5.1, 7.6, 11.5, 16.6, 24.1, 35.0, 50.3, 105.0, 152.0];
const NOISE_NM: f64 = 3e-3;

/// Friction in steps in both directions, with a Stribeck effect and this quadratic coefficient [Nm·s²/rad²].
fn found(square: f64) -> Discovery {
    let run = friction_in_steps(&SPEEDS_RAD_S, 5, 250, |now| {
        let speed = now.velocity.abs();
        let stribeck = 6.7e-3 * (-(speed / 17.7).powi(2)).exp();
        let friction = now.velocity.signum() * (0.019 + 4.6e-5 * speed + stribeck + square * speed * speed);
        friction + NOISE_NM * scatter(now.row, 1)
    });
    let spec = ModelSpec::parse(Kind::Friction, "coulomb,viscous").unwrap();
    discover(&run, &spec, &Options::default(), 4).unwrap()
}

#[test]
fn a_square_of_speed_that_a_stribeck_effect_has_bent_into_is_named() {
    for square in [1.7e-7, 6e-7] {
        let end = found(square);
        assert_eq!(end.model[2..], ["stribeck", "viscous_quadratic"], "{}", end.summary);
        assert_eq!(end.verdict, Verdict::Adequate, "{}", end.summary);
        let tau_c = end.fit.parameters.iter().find(|p| p.name == "tau_c").unwrap().value;
        assert!((tau_c - 0.019).abs() < 0.001, "{tau_c}");
    }
}

#[test]
fn a_stribeck_effect_alone_stays_alone() {
    assert_eq!(found(0.0).model[2..], ["stribeck"]);
}
