//! What leaves the program, used as its reader uses it, gives what the model gives.

mod common;

use common::bench::Staircase;
use common::controller::on_controller;
use common::tables::{meta, scatter, stiffness};
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::transfer::{Format, export};
use jointbench_model::{Fit, ModelSpec, Options, fit, residuals};

const STEP_S: f64 = 0.01;
const NOISE_NM: f64 = 0.018;

/// A joint whose contact slips at 0.3 Nm, to and fro under a torque that creeps up to each level.
fn slipping_joint() -> RunTable {
    let mut trace = stiffness();
    let (mut link, mut torque, mut bent) = (0.0, 0.0f64, 0.0f64);
    for leg in 0..36 {
        let side = if leg % 2 == 0 { 1.0 } else { -1.0 };
        for k in 0..150 {
            let i = (leg * 150 + k) as usize;
            link += side * 0.3 * STEP_S;
            let before = torque;
            torque += (side * f64::from(leg % 12 + 3) - torque) * (STEP_S / 0.27);
            bent = (bent + torque - before).clamp(-0.3, 0.3);
            let twist = 2e-4 * torque + 4e-4 * bent / 0.3 + 2.5e-5 * scatter(i, 1);
            // Sums of four are nearly normal.
            let noise = NOISE_NM * 1.732 * (2..6).map(|mix| scatter(i, mix)).sum::<f64>();
            let row = [i as f64 * STEP_S, 50.0 * (link + twist), link, side * 0.3, torque + noise];
            trace.push_row(&[&row[..], &[f64::from(leg), f64::from(leg / 12)]].concat());
        }
    }
    RunTable::new(meta(Kind::Stiffness), trace).unwrap()
}

/// The figure behind some words of an export.
fn told(text: &str, words: &str) -> f64 {
    let rest = text.split(words).nth(1).unwrap_or_else(|| panic!("{words} in {text}"));
    rest.split_whitespace().next().unwrap().parse().unwrap()
}

fn fitted(run: &RunTable, effects: &str) -> Fit {
    fit(run, &ModelSpec::parse(run.kind(), effects).unwrap(), &Options::default()).unwrap()
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let squares: Vec<f64> = values.map(|v| v * v).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// The fit sees a smooth torque, a controller one with noise on whose peaks a memory would hang.
#[test]
fn c_remembers_a_torque_with_noise_as_the_model_does_a_smooth_one() {
    let run = slipping_joint();
    let fit = fitted(&run, "offset,compliance,torsional_hysteresis");
    let felt: Vec<Vec<f64>> = run.column("link_torque_nm").unwrap().iter().map(|torque| vec![*torque]).collect();
    let Some(said) = on_controller(&fit, "rad", &felt) else { return };
    let of_fit = residuals(&run, &fit, &Options::default()).unwrap();
    let time = &of_fit.axes.iter().find(|axis| axis.name == "time_s").unwrap().values;
    // A point is the mean of the four samples around its moment.
    let first = |moment: &f64| (moment / STEP_S - 1.5).round() as usize;
    let mean = |moment: &f64| said[first(moment)..first(moment) + 4].iter().sum::<f64>() / 4.0;
    let c: Vec<f64> = time.iter().map(mean).collect();
    let apart = rms(c.iter().zip(&of_fit.predicted).map(|(c, model)| c - model));
    assert!(apart < fit.rms, "C and model are {apart} apart, and the model errs by {}", fit.rms);
    let error = rms(c.iter().zip(&of_fit.measured).map(|(c, measured)| c - measured));
    let header = export(&fit, Format::C).unwrap();
    let said = told(&header, "as that run felt it, sample by sample: ");
    assert!((said / error - 1.0).abs() < 0.02, "the header says {said}, and it is {error}");
    assert!(header.contains("torsional_hysteresis_dead_band"), "{header}");

    // A file that does not know the noise has no dead band, hangs on peaks and says so.
    let mut blind = fit.clone();
    blind.scope.iter_mut().flat_map(|scope| &mut scope.signals).for_each(|signal| signal.noise = None);
    assert!(export(&blind, Format::C).unwrap().contains("feed it without noise and without lag"));
    let hangs = on_controller(&blind, "rad", &felt).unwrap();
    let mean = |moment: &f64| hangs[first(moment)..first(moment) + 4].iter().sum::<f64>() / 4.0;
    let apart = rms(time.iter().map(mean).zip(&of_fit.predicted).map(|(c, model)| c - model));
    assert!(apart > 2.0 * fit.rms, "{apart} without a dead band");
}

/// A figure is not to leave without what is known to be wrong with it.
#[test]
fn an_inertia_that_is_not_the_set_ups_says_so_wherever_it_goes() {
    let mut stairs = Staircase { noise_nm: 0.002, scatter_nm: 0.0, seed: 1 }.run(|at| 0.02 * at.velocity.signum());
    let (mut meta, trace) = stairs.into_parts();
    meta.rotor_inertia_kg_m2 = Some(1.0);
    stairs = RunTable::new(meta, trace).unwrap();
    let fit = fitted(&stairs, "load_transmission,inertia,coulomb,viscous");
    let note = fit.notes.iter().find(|note| note.contains("in the set-up")).expect("another inertia");
    let ascii = note.replace('·', "*").replace('²', "^2");
    let header = export(&fit, Format::C).unwrap();
    let field = header.lines().find(|line| line.contains("double inertia_j;")).unwrap();
    assert!(field.contains(&ascii) && header.contains(&format!("Note: {ascii}")), "{header}");
    for format in [Format::Mujoco, Format::Urdf, Format::Table] {
        let text = export(&fit, format).unwrap();
        assert!(text.contains(&format!("Note: {note}")), "{text}");
    }
    let mujoco = export(&fit, Format::Mujoco).unwrap();
    let before = mujoco.split("<joint").next().unwrap().trim_end();
    assert!(before.ends_with(&format!("<!-- armature, motor side: {note} -->")), "{mujoco}");
}
