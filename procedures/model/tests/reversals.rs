//! A joint that changes its gear flanks over a distance: its reversals are no sign of creep.

mod common;

use common::tables::{meta, scatter, stiffness};
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::{ModelSpec, Options, Verdict, discover};

const STEP_S: f64 = 0.004;
const GEAR: f64 = 50.0;
const COMPLIANCE: f64 = 2e-4;
const OFFSET_RAD: f64 = 6e-4;
/// Link speed of a leg after its ramp [rad/s], and samples of ramp and leg.
const SPEED: f64 = 0.5;
const RAMP: usize = 50;
const LEG: usize = 400;
/// Link displacement after which the flank change has decayed to 1/e [rad].
const WAY_RAD: f64 = 5e-3;

/// Back and forth at four loads with ramps in speed; torque and flank follow the displacement since the reversal.
fn run() -> RunTable {
    let mut trace = stiffness();
    let (mut link, mut flank) = (0.0, -1.0f64);
    for leg in 0..32usize {
        let side = if leg % 2 == 0 { 1.0 } else { -1.0 };
        let level = 4.0 * (leg % 8 / 2) as f64;
        for k in 0..LEG {
            let i = leg * LEG + k;
            let share = (k.min(LEG - k) as f64 / RAMP as f64).min(1.0);
            let way = share * SPEED * STEP_S;
            link += side * way;
            flank = side + (flank - side) * (-way / WAY_RAD).exp();
            let torque = level * flank;
            let twist = COMPLIANCE * torque + OFFSET_RAD * flank;
            let motor = (link + twist + 2e-6 * scatter(i, 1)) * GEAR;
            let velocity = side * share * SPEED;
            let measured = torque + 0.002 * scatter(i, 2);
            trace.push_row(&[i as f64 * STEP_S, motor, link, velocity, measured, leg as f64, (leg / 8) as f64]);
        }
    }
    RunTable::new(meta(Kind::Stiffness), trace).unwrap()
}

#[test]
fn a_changing_flank_is_named_nothing() {
    let spec = ModelSpec::parse(Kind::Stiffness, "offset,compliance,directional_offset").unwrap();
    let whole = discover(&run(), &spec, &Options::default(), 4).unwrap();
    assert_eq!(whole.verdict, Verdict::Adequate, "{}", whole.summary);
    let added: Vec<_> = whole.model.iter().filter(|e| !spec.contains(e)).collect();
    assert!(added.is_empty(), "{added:?}: {}", whole.summary);
    for (name, truth) in [("beta_0", OFFSET_RAD), ("inverse_k", COMPLIANCE)] {
        let found = whole.fit.parameters.iter().find(|p| p.name == name).unwrap().value;
        assert!((found / truth - 1.0).abs() < 0.01, "{name} {found} instead of {truth}");
    }
}
