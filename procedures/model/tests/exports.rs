//! Exports, used as their readers use them, give the values of the model.

mod common;

use common::bench::{GEAR, Moment, Staircase};
use common::controller::on_controller;
use common::tables::{meta, scatter, stiffness};
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::export::{Format, export, predict};
use jointbench_model::{Fit, ModelSpec, Options, fit, residuals};

const STEP_S: f64 = 0.01;
const NOISE_NM: f64 = 0.018;

/// A joint whose contact slips at 0.3 Nm, back and forth under a torque that creeps to each level.
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
            // Sums of four uniform variables are nearly normal.
            let noise = NOISE_NM * 1.732 * (2..6).map(|mix| scatter(i, mix)).sum::<f64>();
            let row = [i as f64 * STEP_S, 50.0 * (link + twist), link, side * 0.3, torque + noise];
            trace.push_row(&[&row[..], &[f64::from(leg), f64::from(leg / 12)]].concat());
        }
    }
    RunTable::new(meta(Kind::Stiffness), trace).unwrap()
}

/// The figure after some words of an export.
fn reported(text: &str, words: &str) -> f64 {
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

/// The fit uses a smoothed torque, while a controller measures noise, whose peaks would move a hysteresis state.
#[test]
fn c_remembers_a_torque_with_noise_as_the_model_does_a_smooth_one() {
    let run = slipping_joint();
    let fit = fitted(&run, "offset,compliance,torsional_hysteresis");
    let felt: Vec<Vec<f64>> = run.column("link_torque_nm").unwrap().iter().map(|torque| vec![*torque]).collect();
    let Some(predicted) = on_controller(&fit, "rad", &felt) else { return };
    let of_fit = residuals(&run, &fit, &Options::default()).unwrap();
    let time = &of_fit.axes.iter().find(|axis| axis.name == "time_s").unwrap().values;
    // A point is the mean of the four samples around its moment.
    let first = |moment: &f64| (moment / STEP_S - 1.5).round() as usize;
    let mean = |moment: &f64| predicted[first(moment)..first(moment) + 4].iter().sum::<f64>() / 4.0;
    let c: Vec<f64> = time.iter().map(mean).collect();
    let apart = rms(c.iter().zip(&of_fit.predicted).map(|(c, model)| c - model));
    assert!(apart < fit.rms, "C and model are {apart} apart, and the model errs by {}", fit.rms);
    let error = rms(c.iter().zip(&of_fit.measured).map(|(c, measured)| c - measured));
    let header = export(&fit, Format::C).unwrap();
    let stated = reported(&header, "Error with the measured load of that run, sample by sample: ");
    assert!((stated / error - 1.0).abs() < 0.02, "the header says {stated}, and it is {error}");
    assert!(header.contains("torsional_hysteresis_dead_band"), "{header}");

    // A file without the noise has no dead band, follows the peaks, and states the resulting error.
    let mut blind = fit.clone();
    blind.scope.iter_mut().flat_map(|scope| &mut scope.signals).for_each(|signal| signal.noise = None);
    assert!(export(&blind, Format::C).unwrap().contains("feed it without noise and without lag"));
    let hangs = on_controller(&blind, "rad", &felt).unwrap();
    let mean = |moment: &f64| hangs[first(moment)..first(moment) + 4].iter().sum::<f64>() / 4.0;
    let apart = rms(time.iter().map(mean).zip(&of_fit.predicted).map(|(c, model)| c - model));
    assert!(apart > 2.0 * fit.rms, "{apart} without a dead band");
}

/// An exported figure includes the known problems of the fit.
#[test]
fn an_inertia_that_the_run_does_not_determine_is_the_set_ups_in_every_export() {
    let mut stairs = Staircase { noise_nm: 0.002, scatter_nm: 0.0, seed: 1 }.run(|at| 0.02 * at.velocity.signum());
    let (mut meta, trace) = stairs.into_parts();
    meta.rotor_inertia_kg_m2 = Some(1.0);
    stairs = RunTable::new(meta, trace).unwrap();
    let fit = fitted(&stairs, "load_transmission,inertia,coulomb,viscous");
    let note = fit.notes.iter().find(|note| note.contains("the set-up states")).expect("another inertia");
    let ascii = note.replace('·', "*").replace('²', "^2");
    let header = export(&fit, Format::C).unwrap();
    let field = header.lines().find(|line| line.contains("double inertia_j;")).unwrap();
    assert!(field.contains("not determined by this run") && header.contains(&format!("Note: {ascii}")), "{header}");
    for format in [Format::Mujoco, Format::Urdf, Format::Table] {
        let text = export(&fit, format).unwrap();
        assert!(text.contains(&format!("Note: {note}")), "{text}");
    }
    let mujoco = export(&fit, Format::Mujoco).unwrap();
    let before = mujoco.split("<joint").next().unwrap().trim_end();
    let comment = "<!-- armature, motor side: not determined by this run; the value of the set-up -->";
    assert!(before.ends_with(comment) && mujoco.contains("armature=\"2500\""), "{mujoco}");
}

/// Linear interpolation between the points of a table, at the named axes; the last axis is the fastest.
struct Lut {
    points: Vec<Vec<f64>>,
    values: Vec<f64>,
}

impl Lut {
    fn read(text: &str) -> Self {
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let axes = lines.next().unwrap().split(',').count() - 1;
        let rows: Vec<Vec<f64>> = lines.map(|l| l.split(',').map(|f| f.parse().unwrap()).collect()).collect();
        let points = (0..axes).map(|axis| {
            let mut points: Vec<f64> = rows.iter().map(|row| row[axis]).collect();
            points.sort_by(f64::total_cmp);
            points.dedup();
            points
        });
        Self { points: points.collect(), values: rows.iter().map(|row| row[axes]).collect() }
    }

    fn at(&self, at: &[f64]) -> f64 {
        let mut corners = vec![(0, 1.0)];
        for (points, x) in self.points.iter().zip(at) {
            let cell = points.partition_point(|p| p <= x).clamp(1, points.len() - 1) - 1;
            let share = ((x - points[cell]) / (points[cell + 1] - points[cell])).clamp(0.0, 1.0);
            let next = |(corner, weight): (usize, f64)| {
                [
                    (corner * points.len() + cell, weight * (1.0 - share)),
                    (corner * points.len() + cell + 1, weight * share),
                ]
            };
            corners = corners.into_iter().flat_map(next).collect();
        }
        corners.into_iter().map(|(corner, weight)| weight * self.values[corner]).sum()
    }
}

/// Up to 2 A in steps and down again, to smaller and smaller currents; the torque depends on the history.
fn brake() -> RunTable {
    let names = ["time_s", "brake_current_a", "brake_torque_nm", "segment", "repeat"];
    let mut trace = Trace::new(names.map(Channel::new).to_vec());
    let tops = [20, 14, 8, 20, 14, 8];
    let levels: Vec<i32> =
        tops.into_iter().flat_map(|top: i32| (0..2 * top).map(move |k| top - (k - top).abs())).collect();
    let (mut before, mut state) = (0.0, 0.0f64);
    for (step, level) in levels.iter().enumerate() {
        for k in 0..80 {
            let i = 80 * step + k;
            let current: f64 = before + (f64::from(*level) / 10.0 - before) * 0.2;
            state = (state + current - before).clamp(-0.6, 0.6);
            before = current;
            let torque = 0.5 + 1.5 * (current / 0.9).tanh() + 0.7 * state / 0.6 + 0.01 * scatter(i, 1);
            trace.push_row(&[0.01 * i as f64, current, torque, step as f64, if step < 84 { 0.0 } else { 1.0 }]);
        }
    }
    RunTable::new(meta(Kind::Brake), trace).unwrap()
}

/// The table contains the mean torque of a brake over its branches, and its header the deviation from it.
#[test]
fn a_table_contains_the_mean_of_hysteresis_and_states_its_error() {
    let run = brake();
    let fit = fitted(&run, "drag,torque_per_current,saturation,hysteresis");
    let text = export(&fit, Format::Table).unwrap();
    let lut = Lut::read(&text);
    let (current, torque) = (run.column("brake_current_a").unwrap(), run.column("brake_torque_nm").unwrap());
    let error = rms(current.iter().zip(torque).map(|(i, torque)| lut.at(&[*i]) - torque));
    // The best curve with an independent value for each of 80 sections.
    let stretch = |i: &f64| (i * 40.0 + 0.5) as usize;
    let mut means = vec![(0.0, 0.0); 100];
    for (i, torque) in current.iter().zip(torque) {
        let (sum, count): &mut (f64, f64) = &mut means[stretch(i)];
        (*sum, *count) = (*sum + torque, *count + 1.0);
    }
    let best = rms(current.iter().zip(torque).map(|(i, t)| means[stretch(i)].0 / means[stretch(i)].1 - t));
    assert!(best > 0.1 && error < 1.02 * best, "the table errs by {error}, the best single curve by {best}\n{text}");
    let stated = reported(&text, "# Error: of this table ");
    assert!((stated / error - 1.0).abs() < 0.05, "the header says {stated}, and it is {error}");
    assert!(text.contains("# hysteresis remembers: the table holds its mean over current"), "{text}");
    assert!(!text.contains("NOT CARRIED OVER"), "{text}");
}

/// Ninety angles do not resolve thirty-six waves in a turn.
#[test]
fn a_table_has_points_enough_for_its_fastest_wave() {
    let torque = |at: Moment| {
        let motor = GEAR * at.link;
        0.02 * at.velocity.signum() + 3e-4 * at.velocity + 0.006 * (36.0 * motor + 0.7).sin()
    };
    let run = Staircase { noise_nm: 0.001, scatter_nm: 0.0, seed: 3 }.run(torque);
    let fit = fitted(&run, "load_transmission,coulomb,viscous,cogging");
    let mut flat = fit.clone();
    // Over velocity and angle only.
    flat.effects.retain(|id| id != "load_transmission");
    let text = export(&flat, Format::Table).unwrap();
    let lut = Lut::read(&text);
    assert_eq!(lut.points[1].len(), 16 * 36 + 1, "{}", text.lines().take(12).collect::<Vec<_>>().join("\n"));
    let asked: Vec<[f64; 2]> = (0..3000).map(|i| [1.0 + 0.01 * scatter(i, 1), 3.1 + 6.0 * scatter(i, 2)]).collect();
    let column = |k: usize| asked.iter().map(|at| at[k]).collect::<Vec<f64>>();
    let moments = [("velocity", column(0)), ("position", column(1)), ("direction", vec![1.0; asked.len()])];
    let model = predict(&flat, &moments, 0.004).unwrap();
    let off = rms(asked.iter().zip(&model).map(|(at, model)| lut.at(at) - model));
    assert!(off < 0.02 * 0.006, "{off}");
    let stated = reported(&text, "it is off what it is a table of by ");
    assert!(off < 1.5 * stated && stated < 0.02 * 0.006, "the header says {stated}, and it is {off}");
}
