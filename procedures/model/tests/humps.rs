//! A local maximum of friction over speed is outside the library, even if two cancelling effects imitate it.

mod common;

use common::bench::{Moment, Staircase};
use common::tables::{friction_in_steps, scatter};
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, Verdict, diagnose, discover};

const SPEEDS_RAD_S: [f64; 13] = [0.8, 1.2, 1.8, 2.7, 4.1, 6.1, 9.1, 13.7, 20.5, 30.8, 46.1, 69.2, 103.8];

/// Friction with an additional torque of `height_nm` around one speed, with a width of `wide` in its logarithm.
fn run(speed_rad_s: f64, wide: f64, height_nm: f64, seed: u64) -> RunTable {
    let (mut meta, trace) = friction_in_steps(&SPEEDS_RAD_S, 3, 220, |now| {
        let speed = now.velocity.abs();
        let hump = height_nm * (-0.5 * ((speed / speed_rad_s).ln() / wide).powi(2)).exp();
        let noise = 4e-3 * scatter(now.row, seed) + 4e-4 * scatter(now.leg, seed + 9);
        now.velocity.signum() * (0.016 + 4e-5 * speed + hump) + noise
    })
    .into_parts();
    meta.gear_ratio = Some(1.0);
    RunTable::new(meta, trace).unwrap()
}

#[test]
fn a_hump_over_the_speed_is_structure() {
    for (speed, wide, height, seed) in [(8.0, 0.3, 2.5e-3, 1), (8.0, 0.3, 2.5e-3, 2), (14.0, 0.2, 1.5e-3, 2)] {
        let run = run(speed, wide, height, seed);
        let spec = ModelSpec::parse(Kind::Friction, "coulomb,viscous").unwrap();
        let found = discover(&run, &spec, &Options::default(), 4).unwrap();
        assert_eq!(found.verdict, Verdict::UnexplainedStructure, "{speed} rad/s: {}", found.summary);
        // Earlier versions named viscous_sublinear and viscous_quadratic, with negative Coulomb friction between
        // them.
        assert_eq!(found.model, ["coulomb", "viscous"], "{speed} rad/s, {seed}");
    }
}

#[test]
fn a_hump_that_few_speeds_show_is_structure_too() {
    for seed in 1..4 {
        // One of ten speeds is on it: if that speed is left out with all its repeats, the others do not show it.
        let bench = Staircase { noise_nm: 2e-3, scatter_nm: 2e-4, seed };
        let run = bench.run_at(&[0.0], |m: Moment| {
            let hump = 4e-3 * (-0.5 * ((m.velocity.abs() - 20.3) / 4.0).powi(2)).exp();
            m.velocity.signum() * (0.02 + 1.5e-4 * m.velocity.abs() + hump)
        });
        let spec = ModelSpec::parse(Kind::Friction, "coulomb,viscous").unwrap();
        let found = diagnose(&run, &spec, &Options::default()).unwrap();
        assert_eq!(found.verdict, Verdict::UnexplainedStructure, "{seed}: {}", found.summary);
        assert!(found.shows_over.iter().any(|axis| axis.contains("velocity")), "{:?}", found.shows_over);
    }
}

/// Each speed occurs twice: no part of the axis has a band, and the start angles of slow steps would be reported.
#[test]
fn a_residual_over_speeds_with_one_repeat_is_reported_over_speed() {
    let (mut meta, trace) = friction_in_steps(&SPEEDS_RAD_S[..10], 2, 220, |now| {
        let speed = now.velocity.abs();
        now.velocity.signum() * (0.02 + 0.012 * (-speed / 4.0).exp() + 1e-4 * speed) + 1e-3 * scatter(now.row, 3)
    })
    .into_parts();
    meta.gear_ratio = Some(1.0);
    let numbered = |channel: &Channel| ["segment", "repeat"].contains(&&*channel.name);
    let kept = trace.channels().iter().cloned().zip(trace.columns().to_vec()).filter(|(channel, _)| !numbered(channel));
    let (channels, columns) = kept.unzip();
    let run = RunTable::new(meta, Trace::from_columns(channels, columns)).unwrap();
    let found = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
    assert_eq!(found.suggestions.first().map(|s| &*s.effect), Some("stribeck"), "{}", found.summary);
    assert!(found.regions.iter().all(|region| region.axis != "link_position_rad"), "{:?}", found.regions);
    assert!(found.summary.contains("a function of motor velocity would remove"), "{}", found.summary);
}
