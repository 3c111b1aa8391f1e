//! Several dry contacts in one joint are found as such, not as the most similar other effect.

mod common;

use common::tables::{meta, scatter, stiffness};
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::{ModelSpec, Options, discover};

const STEP_S: f64 = 0.01;
const GEAR: f64 = 50.0;
/// Torque at which each contact slips [Nm], and its twist at that torque [rad].
const CONTACTS: [(f64, f64); 2] = [(1.0, 2e-4), (5.0, 4e-4)];
const COMPLIANCE: f64 = 4e-4;
const NOISE_RAD: f64 = 2e-5;

/// A joint that turns back and forth under a torque that follows its direction, level by level.
fn run() -> RunTable {
    let mut trace = stiffness();
    let (mut link, mut torque, mut bent) = (0.0, 0.0f64, [0.0f64; 2]);
    for leg in 0..36 {
        let side = if leg % 2 == 0 { 1.0 } else { -1.0 };
        let level = 2.0 * f64::from(leg % 12 / 2 + 1);
        for k in 0..100 {
            let i = (leg * 100 + k) as usize;
            link += side * 0.3 * STEP_S;
            let before = torque;
            torque += (side * level - torque) * (STEP_S / 0.2);
            let mut twist = COMPLIANCE * torque;
            for (bent, (slips, carries)) in bent.iter_mut().zip(CONTACTS) {
                *bent = (*bent + torque - before).clamp(-slips, slips);
                twist += carries * *bent / slips;
            }
            let motor = (link + twist + 3.5 * NOISE_RAD * scatter(i, 1)) * GEAR;
            let measured = torque + 0.01 * scatter(i, 2);
            trace.push_row(&[
                i as f64 * STEP_S,
                motor,
                link,
                side * 0.3,
                measured,
                f64::from(leg),
                f64::from(leg / 12),
            ]);
        }
    }
    RunTable::new(meta(Kind::Stiffness), trace).unwrap()
}

#[test]
fn two_contacts_are_two_and_leave_only_noise() {
    let run = run();
    let spec = ModelSpec::baseline(&run).unwrap();
    let whole = discover(&run, &spec, &Options::default(), 4).unwrap();
    let added: Vec<_> = whole.model.iter().filter(|e| !spec.contains(e)).collect();
    assert_eq!(added, ["torsional_hysteresis"], "{}", whole.summary);
    let (end, floor) = (whole.steps.last().unwrap().validation_rms, whole.noise_floor_rms.unwrap());
    assert!(end < 1.1 * floor, "{end} against the floor {floor}");
    for (name, truth) in
        [("tau_eta", CONTACTS[0].0), ("tau_eta_2", CONTACTS[1].0), ("eta", CONTACTS[0].1), ("eta_2", CONTACTS[1].1)]
    {
        let found = whole.fit.parameters.iter().find(|p| p.name == name).unwrap().value;
        assert!((found / truth - 1.0).abs() < 0.1, "{name} {found} instead of {truth}");
    }
}
