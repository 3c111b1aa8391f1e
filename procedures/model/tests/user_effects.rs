//! User effects on simulated runs: fitted, suggested, discovered, refused.

mod common;

use common::bench::{Moment, Staircase};
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::{
    Fit, ModelError, ModelSpec, Options, UserEffect, Verdict, diagnose, discover, evaluate, fit, residuals,
};

const RUB: &str = "rub: tau = a * sqrt(abs(load) * abs(velocity)) * exp(-abs(velocity) / w0) * direction; \
                   a [1] 0..1; w0 [rad/s] 1..100";

fn truth(m: Moment) -> f64 {
    let rub = (m.load.abs() / 50.0 * m.velocity.abs()).sqrt() * (-m.velocity.abs() / 18.0).exp();
    0.03 * m.velocity.signum() + 1.5e-4 * m.velocity + 0.05 * rub * m.velocity.signum()
}

fn measured(seed: u64) -> RunTable {
    Staircase { noise_nm: 2e-3, scatter_nm: 1e-4, seed }.run(truth)
}

fn own(text: &str) -> Vec<UserEffect> {
    vec![UserEffect::inline(Kind::Friction, text).unwrap()]
}

fn spec(run: &RunTable, more: &[&str], text: &str) -> ModelSpec {
    let baseline = run.meta().baseline.iter().map(String::as_str);
    ModelSpec::with_user_effects(Kind::Friction, baseline.chain(more.iter().copied()), own(text)).unwrap()
}

fn parameter(fit: &Fit, name: &str) -> f64 {
    fit.parameters.iter().find(|p| p.name == name).unwrap().value
}

#[test]
fn a_formula_is_fitted_with_its_shape() {
    let run = measured(1);
    let found = fit(&run, &spec(&run, &["rub"], RUB), &Options::default()).unwrap();
    for (name, truth, budget) in [("a", 0.05, 5e-4), ("w0", 18.0, 0.2), ("tau_c", 0.03, 2e-4)] {
        assert!((parameter(&found, name) - truth).abs() < budget, "{name} {}", parameter(&found, name));
    }
    let shape = found.parameters.iter().find(|p| p.name == "w0").unwrap();
    assert!(shape.unit == "rad/s" && shape.ci95[0] < 18.0 && 18.0 < shape.ci95[1], "{shape:?}");
}

#[test]
fn a_size_beyond_its_range_is_reported_with_the_range() {
    let run = measured(1);
    let found = fit(&run, &spec(&run, &["rub"], &RUB.replace("0..1;", "0..0.01;")), &Options::default()).unwrap();
    let note = found.parameters.iter().find(|p| p.name == "a").unwrap().note.as_ref().unwrap();
    assert!(note.starts_with("is outside its physical range (0.00 to 0.01): "), "{note}");
}

#[test]
fn a_fit_carries_its_formulas() {
    let run = measured(2);
    let found = fit(&run, &spec(&run, &["rub"], RUB), &Options::default()).unwrap();
    let again: Fit = serde_json::from_str(&serde_json::to_string(&found).unwrap()).unwrap();
    let other = measured(3);
    let held = evaluate(&again, &other).unwrap();
    assert!((held.rms / found.rms - 1.0).abs() < 0.1, "{} and {}", held.rms, found.rms);
    let set = residuals(&run, &again, &Options::default()).unwrap();
    let judged: Vec<f64> = set.error.iter().zip(&set.held_out).filter(|(_, h)| !**h).map(|(e, _)| *e).collect();
    let rms = (judged.iter().map(|e| e * e).sum::<f64>() / judged.len() as f64).sqrt();
    assert!((rms / found.rms - 1.0).abs() < 1e-9, "{rms} {}", found.rms);
}

#[test]
fn a_formula_is_a_candidate_like_any_other() {
    let run = measured(4);
    let spec = spec(&run, &[], RUB);
    let first = diagnose(&run, &spec, &Options::default()).unwrap();
    assert_eq!(first.suggestions.first().map(|s| s.effect.as_str()), Some("rub"), "{}", first.summary);
    let rub = &first.suggestions[0];
    let [low, high] = rub.error_reduction_ci95.unwrap();
    assert!(0.0 < low && low < rub.error_reduction && rub.error_reduction < high && high < 1.0, "{rub:?}");
    assert!(rub.bic_change.unwrap() < -10.0, "{rub:?}");
    let whole = discover(&run, &spec, &Options::default(), 4).unwrap();
    assert_eq!(whole.model.last().map(String::as_str), Some("rub"), "{:?}", whole.model);
    assert_eq!((whole.verdict, whole.fit.user_effects.len()), (Verdict::Adequate, 1), "{}", whole.summary);
}

#[test]
fn a_formula_that_is_not_needed_stays_silent() {
    let run = Staircase { noise_nm: 2e-3, scatter_nm: 1e-4, seed: 5 }
        .run(|m| 0.03 * m.velocity.signum() + 1.5e-4 * m.velocity);
    let found = diagnose(&run, &spec(&run, &[], RUB), &Options::default()).unwrap();
    assert_eq!(found.verdict, Verdict::Adequate, "{}", found.summary);
    assert!(found.silent.iter().any(|s| s.effect == "rub" && s.minimum_detectable_rms > 0.0));

    let known = found.silent.len() + found.not_visible.len();
    let bounded = found.clone().bounded();
    assert!(bounded.silent.iter().all(|s| s.upper_rms.is_some_and(|upper| upper > s.minimum_detectable_rms)));
    // With a residual of a thousand times the signal every limit exceeds the signal.
    let mut loud = found.clone();
    loud.fit.relative_error *= 1e3;
    let hidden = loud.bounded();
    let why = hidden.not_visible.iter().find(|one| one.effect == "rub").map(|one| one.why.as_str()).unwrap_or_default();
    assert!(hidden.silent.is_empty() && why.contains("% of the measured signal, above the bound of 5.0 %"), "{why}");
    for one in [bounded, hidden] {
        assert_eq!(one.silent.len() + one.not_visible.len(), known, "no effect is omitted");
    }
}

#[test]
fn a_formula_that_the_library_has_is_reported_as_its_copy() {
    let run = Staircase { noise_nm: 2e-3, scatter_nm: 1e-4, seed: 7 }
        .run(|m| (0.03 + 0.06 * m.load.abs() / 50.0) * m.velocity.signum() + 1.5e-4 * m.velocity);
    let is_replicate = "twin: tau = a * abs(load) * sign(velocity); a [1] 0..1";
    let found = diagnose(&run, &spec(&run, &[], is_replicate), &Options::default()).unwrap();
    let first = &found.suggestions[0];
    assert_eq!((first.effect.as_str(), first.confounded_with.contains(&"twin".into())), ("load_linear", true));
    let reported = found.left_out.iter().find(|n| n.effect == "twin").unwrap();
    assert!(
        reported.why.starts_with("load_linear is in the model, and this run cannot distinguish them"),
        "{}",
        reported.why
    );
}

#[test]
fn an_effect_of_the_library_comes_before_a_shorter_formula_that_explains_the_same() {
    let run = Staircase { noise_nm: 2e-3, scatter_nm: 1e-4, seed: 9 }
        .run(|m| (0.03 + 0.02 * (-m.velocity.abs() / 8.0).exp()) * m.velocity.signum() + 1.5e-4 * m.velocity);
    // The law of the simulation with a fixed speed: one coefficient, where stribeck has three parameters.
    let same = "peak: tau = a * exp(-abs(velocity) / 8) * direction; a [Nm]";
    let found = diagnose(&run, &spec(&run, &[], same), &Options::default()).unwrap();
    let named: Vec<&str> = found.suggestions.iter().map(|s| s.effect.as_str()).collect();
    assert_eq!(named, ["stribeck"], "{}", found.summary);
    assert_eq!(found.suggestions[0].confounded_with, ["peak"]);
}

#[test]
fn many_formulas_do_not_displace_an_effect_of_the_library() {
    let run = Staircase { noise_nm: 2e-3, scatter_nm: 1e-4, seed: 10 }
        .run(|m| (0.03 + 0.06 * m.load.abs() / 50.0) * m.velocity.signum() + 1.5e-4 * m.velocity);
    // Each contains the missing effect and a term that this run cannot show.
    let copy =
        |n: usize| format!("copy_{n}: tau = a * abs(load) * direction + b * sin({n} * link_position); a [1]; b [Nm]");
    let copies = (1..=12).flat_map(|n| own(&copy(n))).collect();
    let spec = ModelSpec::with_user_effects(Kind::Friction, run.meta().baseline.iter(), copies).unwrap();
    let found = diagnose(&run, &spec, &Options::default()).unwrap();
    assert_eq!(found.suggestions.first().map(|s| s.effect.as_str()), Some("load_linear"), "{}", found.summary);
}

#[test]
fn a_shape_may_be_negative() {
    let run = Staircase { noise_nm: 2e-3, scatter_nm: 1e-4, seed: 6 }
        .run(|m| 0.03 * m.velocity.signum() + 1.5e-4 * m.velocity + 0.02 * ((m.velocity + 15.0) / 9.0).tanh());
    let text = "edge: tau = a * tanh((velocity - v0) / 9); a [Nm]; v0 [rad/s] -40..40";
    let found = fit(&run, &spec(&run, &["edge"], text), &Options::default()).unwrap();
    assert!((parameter(&found, "v0") + 15.0).abs() < 0.3, "{}", parameter(&found, "v0"));
}

#[test]
fn whole_numbers_are_found() {
    let run = Staircase { noise_nm: 1e-3, scatter_nm: 1e-4, seed: 7 }
        .run(|m| 0.03 * m.velocity.signum() + 1.5e-4 * m.velocity + 0.006 * (7.0 * m.link + 0.4).cos());
    let text = "wave: tau = a * cos(h * link_position) + b * sin(h * link_position); \
                a [Nm]; b [Nm]; h [1/turn] 1..20 whole";
    let found = fit(&run, &spec(&run, &["wave"], text), &Options::default()).unwrap();
    assert_eq!(parameter(&found, "h"), 7.0);
    let amplitude = parameter(&found, "a").hypot(parameter(&found, "b"));
    assert!((amplitude - 0.006).abs() < 1e-4, "{amplitude}");
}

#[test]
fn what_cannot_be_is_refused_with_words() {
    let run = measured(8);
    let broken = spec(&run, &["bad"], "bad: tau = a * sqrt(velocity); a [Nm]");
    let error = fit(&run, &broken, &Options::default()).unwrap_err();
    assert!(matches!(&error, ModelError::NotFinite { first, .. } if first.contains("velocity = -")), "{error}");
    let cold = spec(&run, &["warm"], "warm: tau = a * temperature; a [Nm]");
    let found = fit(&run, &cold, &Options::default()).unwrap();
    assert!(found.notes.iter().any(|n| n.contains("no column temperature_c")), "{:?}", found.notes);
    let twice = [own(RUB), own(RUB)].concat();
    assert_eq!(
        ModelSpec::with_user_effects(Kind::Friction, ["coulomb"], twice),
        Err(ModelError::TwiceNamed("rub".into()))
    );
}
