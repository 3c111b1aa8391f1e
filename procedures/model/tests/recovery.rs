//! Recovery of the simulated truth: parameters within tolerances, hidden effects by name, and no effect if there is
//! none.

mod common;

use common::bench::{Moment, Staircase};
use jointbench_model::{Diagnosis, ModelSpec, Options, Verdict, diagnose, discover, evaluate, fit};

const COULOMB: f64 = 0.030;
const VISCOUS: f64 = 1.5e-4;

fn dry(m: Moment) -> f64 {
    COULOMB * m.velocity.signum() + VISCOUS * m.velocity
}

fn bench(seed: u64) -> Staircase {
    Staircase { noise_nm: 2e-3, scatter_nm: 1e-4, seed }
}

#[test]
fn parameters_come_back_within_their_budgets_and_intervals() {
    let run = bench(1).run(dry);
    let found = fit(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
    for (name, truth, budget) in [("tau_c", COULOMB, 2e-4), ("c_v", VISCOUS, 2e-6)] {
        let p = found.parameters.iter().find(|p| p.name == name).unwrap();
        assert!((p.value - truth).abs() < budget, "{name} {}", p.value);
        assert!(p.ci95[0] < p.value && p.value < p.ci95[1]);
    }
}

#[test]
fn intervals_hold_the_truth_in_spite_of_segment_scatter() {
    let (runs, mut inside) = (60, 0);
    for seed in 0..runs {
        let run = Staircase { noise_nm: 2e-3, scatter_nm: 6e-4, seed: 100 + seed }.run(dry);
        let found = fit(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
        let holds = |name: &str, truth: f64| {
            let p = found.parameters.iter().find(|p| p.name == name).unwrap();
            u32::from(p.ci95[0] < truth && truth < p.ci95[1])
        };
        inside += holds("tau_c", COULOMB) + holds("c_v", VISCOUS);
    }
    let share = f64::from(inside) / (2.0 * runs as f64);
    assert!(share > 0.88, "95 % intervals hold the truth in {share}");
}

fn check_found(name: &str, seed: u64, friction: impl Fn(Moment) -> f64) {
    let run = bench(seed).run(friction);
    let spec = ModelSpec::baseline(&run).unwrap();
    let first = diagnose(&run, &spec, &Options::default()).unwrap();
    assert_eq!(first.suggestions.first().map(|s| s.effect.as_str()), Some(name), "{}", first.summary);
    assert_eq!(first.verdict, Verdict::MissingEffect);
    assert!(first.suggestions[0].p_value <= 0.05 && first.suggestions[0].error_reduction > 0.0);
    let whole = discover(&run, &spec, &Options::default(), 4).unwrap();
    let added: Vec<_> = whole.model.iter().filter(|e| !spec.contains(e)).collect();
    assert_eq!(added, [name], "{}", whole.summary);
    // Consistency: the suggestions equal the final model of the search, and a fit of the same effects in any order.
    let mut effects = whole.model.clone();
    effects.reverse();
    let same = fit(&run, &ModelSpec::new(spec.kind, effects).unwrap(), &Options::default()).unwrap();
    for parameter in whole.fit.parameters.iter().filter(|p| p.effect == name) {
        assert!(same.parameters.contains(parameter), "{parameter:?} is not among {:?}", same.parameters);
        assert!(first.suggestions[0].parameters.contains(parameter), "{:?}", first.suggestions);
    }
    let last = whole.steps.last().unwrap().validation_rms;
    assert!(last < 1.1 * whole.noise_floor_rms.unwrap(), "{last} against the floor {:?}", whole.noise_floor_rms);
}

#[test]
fn a_hidden_effect_is_named() {
    check_found("stribeck", 2, |m| dry(m) + 0.012 * m.velocity.signum() / (1.0 + (m.velocity / 6.0).powi(2)).powi(2));
    check_found("load_linear", 3, |m| dry(m) + 0.08 * m.load / 50.0);
    check_found("direction_offset", 4, |m| dry(m) + 0.004);
    check_found("viscous_asymmetry", 5, |m| dry(m) + 4e-5 * m.velocity.abs());
    check_found("drift", 6, |m| dry(m) + 1e-4 * m.time);
    check_found("drift", 7, |m| dry(m) + 8e-3 * (1.0 - (-m.time / 25.0).exp()));
}

/// A given Stribeck peak imitates a missing Coulomb or viscous friction.
#[test]
fn what_is_taken_out_of_a_complete_model_is_what_is_named() {
    let peak = |m: Moment| 0.012 * m.velocity.signum() / (1.0 + (m.velocity / 6.0).powi(2)).powi(2);
    let run = bench(9).run(|m| dry(m) + peak(m));
    let complete = ["load_transmission", "coulomb", "viscous", "stribeck"];
    for removed in complete {
        let rest = complete.into_iter().filter(|e| *e != removed);
        let found = diagnose(&run, &ModelSpec::new(run.kind(), rest).unwrap(), &Options::default()).unwrap();
        let named: Vec<&str> = found.suggestions.iter().map(|s| s.effect.as_str()).collect();
        assert_eq!(named, [removed], "without {removed}: {}", found.summary);
        assert!(found.suggestions[0].error_reduction > 0.1, "{:?}", found.suggestions);
    }
}

/// Chunks of one sample give so many rows that neighbours are averaged.
#[test]
fn a_run_of_many_chunks_says_the_same_in_fewer_rows() {
    let run = bench(8).run(|m| dry(m) + 0.004 * m.link.cos());
    let spec = ModelSpec::baseline(&run).unwrap();
    let reported = |chunk_s| diagnose(&run, &spec, &Options { chunk_s, ..Options::default() }).unwrap();
    let (few, many) = (reported(None), reported(Some(0.004)));
    let settled = run.len() * 3 / 4;
    assert!((2_000..12_000).contains(&many.fit.preparation.rows) && settled > 12_000, "{:?}", many.fit.preparation);
    for found in [&few, &many] {
        assert_eq!(found.suggestions[0].effect, "gravity", "{}", found.summary);
    }
    let value = |found: &Diagnosis, name: &str| found.fit.parameters.iter().find(|p| p.name == name).unwrap().value;
    assert!((value(&few, "tau_c") - value(&many, "tau_c")).abs() < 1e-4);
}

#[test]
fn nothing_is_named_where_nothing_is_missing() {
    let mut alarms = Vec::new();
    for seed in 0..40 {
        let run = Staircase { noise_nm: 2e-3, scatter_nm: 4e-4, seed: 300 + seed }.run(dry);
        let found = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
        if found.verdict != Verdict::Adequate {
            alarms.push(found.summary);
        }
    }
    assert!(alarms.len() <= 3, "{} of 40: {alarms:?}", alarms.len());
}

#[test]
fn what_the_library_does_not_know_is_called_structure_and_shown() {
    let run = bench(7).run(|m| {
        let bump = (-((m.velocity.abs() - 20.3) / 2.0).powi(2)).exp();
        dry(m) * (1.0 + 0.5 * bump)
    });
    let found = discover(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default(), 4).unwrap();
    assert_eq!(found.verdict, Verdict::UnexplainedStructure, "{}", found.summary);
    let shown = |r: &jointbench_model::Region| r.axis == "motor_velocity_rad_s" && r.from < 21.0 && r.to > 19.0;
    assert!(found.regions.iter().any(shown), "{:?}", found.regions);
}

#[test]
fn regions_follow_from_the_residual() {
    // A Stribeck effect at the end of its range imitates the viscous friction.
    let run = bench(9).run(dry);
    let spec = ModelSpec::new(run.kind(), ["load_transmission", "coulomb", "stribeck"]).unwrap();
    let found = diagnose(&run, &spec, &Options::default()).unwrap();
    assert_eq!(found.verdict, Verdict::MissingEffect, "{}", found.summary);
    let worst = found.regions.iter().map(|region| region.mean_residual.abs()).fold(0.0, f64::max);
    assert!(worst > found.fit.rms, "{worst} Nm of {} Nm", found.fit.rms);
}

#[test]
fn a_model_says_where_it_is_an_extrapolation() {
    let light = bench(3).run_at(&[0.0, 2.0, 4.0], dry);
    let model = fit(&light, &ModelSpec::baseline(&light).unwrap(), &Options::default()).unwrap();
    assert_eq!(evaluate(&model, &light).unwrap().notes, Vec::<String>::new());
    let notes = evaluate(&model, &bench(4).run_at(&[0.0, 4.0, 12.0], dry)).unwrap().notes;
    assert!(
        notes.len() == 1 && notes[0].contains("outside the load that the model was fitted to (−4.00 Nm"),
        "{notes:?}"
    );
}

#[test]
fn the_range_of_acceleration_is_that_of_the_ramps() {
    let run = bench(5).run(dry);
    let baseline = run.meta().baseline.iter().map(String::as_str);
    let spec = ModelSpec::new(run.kind(), baseline.chain(["inertia"])).unwrap();
    let model = fit(&run, &spec, &Options::default()).unwrap();
    assert!(model.parameters.iter().any(|p| p.effect == "inertia" && p.ci95[0] < p.ci95[1]), "{:?}", model.parameters);
    let ranges = &model.scope.as_ref().unwrap().signals;
    let acceleration = ranges.iter().find(|r| r.name == "acceleration").unwrap();
    assert!(acceleration.min < -10.0 && acceleration.max > 10.0, "{acceleration:?}");
}
