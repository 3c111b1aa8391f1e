//! Diagnoses of any run content give a clear verdict or error: no panic, and no suggestion without evidence.

mod common;

use common::bench::{Staircase, meta};
use common::tables::{Shape, scatter, try_table};
use jointbench_instrument::{Channel, Kind, Meta, RunTable, TableFault, Trace};
use jointbench_model::{Diagnosis, ModelError, ModelSpec, Options, UndecidedReason, Verdict, diagnose, fit, maps};
use proptest::prelude::*;

fn table(rows: usize, current: impl Fn(usize) -> f64, position: impl Fn(usize) -> f64) -> RunTable {
    let names = ["time_s", "motor_position_rad", "motor_current_a"];
    let mut trace = Trace::new(names.iter().map(|n| Channel::new(*n)).collect());
    (0..rows).for_each(|i| trace.push_row(&[i as f64 * 0.004, position(i), current(i)]));
    RunTable::new(Meta { baseline: vec!["coulomb".into(), "viscous".into()], ..meta() }, trace).unwrap()
}

fn error(run: &RunTable) -> ModelError {
    diagnose(run, &ModelSpec::baseline(run).unwrap(), &Options::default()).unwrap_err()
}

#[test]
fn what_cannot_be_identified_is_refused_in_words() {
    assert!(matches!(error(&table(3, |_| 1.0, |i| i as f64)), ModelError::TooFewSamples { usable: 3, .. }));
    assert!(matches!(error(&table(500, |_| 1.0, |_| 2.0)), ModelError::Constant { .. }));
}

#[test]
fn one_direction_at_one_speed_names_the_confounded_effects() {
    let run = table(500, |i| 1.0 + 0.01 * scatter(i, 0), |i| i as f64 * 0.1);
    let spec = ModelSpec::baseline(&run).unwrap();
    match diagnose(&run, &spec, &Options::default()) {
        Ok(found) => {
            assert!(found.suggestions.is_empty(), "{}", found.summary);
            let pair = &found.fit.trade_offs[0];
            assert_eq!((pair.first.as_str(), pair.second.as_str()), ("coulomb.tau_c", "viscous.c_v"));
        }
        Err(refused) => assert!(matches!(refused, ModelError::Collinear { .. }), "{refused}"),
    }
}

#[test]
fn a_model_of_another_kind_or_an_unknown_effect_is_refused() {
    let run = table(500, |i| (i as f64 * 0.3).cos(), |i| (i as f64 * 0.05).sin());
    let spec = ModelSpec::new(Kind::Brake, ["drag"]).unwrap();
    assert!(matches!(fit(&run, &spec, &Options::default()), Err(ModelError::WrongKind { .. })));
    assert!(matches!(ModelSpec::parse(Kind::Friction, "coulomb,stickslip"), Err(ModelError::UnknownEffect { .. })));
    assert!(matches!(ModelSpec::parse(Kind::Friction, "coulomb, coulomb"), Err(ModelError::TwiceNamed(_))));
    assert!(matches!(ModelSpec::parse(Kind::Friction, " ,"), Err(ModelError::EmptyModel)));
}

#[test]
fn an_effect_without_its_signal_stays_in_the_model_as_not_visible() {
    let wave = |i: usize| (i as f64 * 0.02).sin() * 5.0;
    let run = table(2000, |i| 0.4 * (i as f64 * 0.02).cos().signum() + 0.01 * (i as f64 * 1.3).sin(), wave);
    let spec = ModelSpec::parse(Kind::Friction, "coulomb,viscous,load_linear").unwrap();
    let found = fit(&run, &spec, &Options::default()).unwrap();
    assert!(found.notes.iter().any(|n| n.contains("load_linear is not testable")), "{:?}", found.notes);
}

#[test]
fn a_clock_that_runs_back_and_numbers_that_are_none_never_become_a_run() {
    for kind in Kind::ALL {
        let shape = Shape { rows: 200, ..Shape::default() };
        let spoilt = |column: &'static str, value: f64| {
            try_table(kind, &shape, move |name, i, v| if name == column && i == 120 { value } else { v })
        };
        assert!(matches!(spoilt("time_s", 0.1), Err(TableFault::TimeNotRising { .. })), "{kind}");
        let still = try_table(kind, &shape, |name, _, v| if name == "time_s" { 1.0 } else { v });
        assert!(matches!(still, Err(TableFault::TimeNotRising { .. })), "{kind}");
        for column in kind.required_columns() {
            assert!(matches!(spoilt(column, f64::NAN), Err(TableFault::NotFinite { .. })), "{kind} {column}");
        }
    }
}

#[test]
fn a_column_that_never_changes_is_a_clear_error_or_nothing_to_say() {
    for kind in Kind::ALL {
        for column in kind.required_columns().iter().filter(|c| **c != "time_s") {
            let run = try_table(kind, &Shape::default(), |name, _, v| if name == *column { 0.7 } else { v }).unwrap();
            match diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()) {
                Ok(found) => assert_finite(&found),
                Err(refused) => assert!(refused.to_string().len() > 20, "{kind} {column}: {refused}"),
            }
        }
    }
}

#[test]
fn a_response_that_never_changes_is_an_error_that_names_it() {
    for (kind, column) in [(Kind::Friction, "motor_current_a"), (Kind::Brake, "brake_torque_nm")] {
        for value in [0.0, 0.7] {
            let run = try_table(kind, &Shape::default(), |name, _, v| if name == column { value } else { v }).unwrap();
            match diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()) {
                Err(ModelError::Constant { column: named }) => assert_eq!(named, column),
                other => panic!("{kind} {column} = {value}: {other:?}"),
            }
        }
    }
}

#[test]
fn numbers_that_nothing_can_be_computed_with_are_refused_by_their_column() {
    for kind in Kind::ALL {
        for column in kind.required_columns().iter().filter(|c| **c != "time_s") {
            let run =
                try_table(kind, &Shape::default(), |name, _, v| if name == *column { 1e200 * v } else { v }).unwrap();
            let refused = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap_err();
            assert!(matches!(&refused, ModelError::TooLarge { column: named, .. } if named == column), "{refused}");
        }
    }
}

#[test]
fn a_column_that_no_model_uses_does_not_block_a_run() {
    let run = Staircase { noise_nm: 2e-3, scatter_nm: 1e-4, seed: 1 }.run_at(&[2.0], |m| 0.03 * m.velocity.signum());
    let (meta, trace) = run.clone().into_parts();
    let (mut channels, mut columns) = (trace.channels().to_vec(), trace.columns().to_vec());
    channels.push(Channel::new("observer_state"));
    columns.push(vec![2.3e200; run.len()]);
    let more = RunTable::new(meta, Trace::from_columns(channels, columns)).unwrap();
    let summary =
        |run: &RunTable| diagnose(run, &ModelSpec::baseline(run).unwrap(), &Options::default()).unwrap().summary;
    assert_eq!(summary(&more), summary(&run));
}

#[test]
fn a_load_that_never_changes_is_reported_first() {
    let run = Staircase { noise_nm: 2e-3, scatter_nm: 1e-4, seed: 1 }.run_at(&[0.0], |m| 0.03 * m.velocity.signum());
    let found = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
    assert!(found.summary.starts_with("Data problem: link_torque_nm never changes"), "{}", found.summary);
    assert!(found.suggestions.is_empty());
}

#[test]
fn options_out_of_range_are_refused_by_name() {
    let run = table(500, |i| (i as f64 * 0.3).cos(), |i| (i as f64 * 0.05).sin());
    let spec = ModelSpec::baseline(&run).unwrap();
    for (name, options) in [
        ("alpha", Options { alpha: f64::NAN, ..Options::default() }),
        ("practical_share", Options { practical_share: 1.0, ..Options::default() }),
        ("cutoff_hz", Options { cutoff_hz: Some(f64::INFINITY), ..Options::default() }),
        ("decimation", Options { decimation: Some(0), ..Options::default() }),
        ("chunk_s", Options { chunk_s: Some(-1.0), ..Options::default() }),
    ] {
        match diagnose(&run, &spec, &options) {
            Err(ModelError::BadOption { option, .. }) => assert_eq!(option, name),
            other => panic!("{name}: {other:?}"),
        }
    }
}

/// All figures are finite, and nothing is suggested without evidence.
fn assert_finite(found: &Diagnosis) {
    assert!(found.fit.rms.is_finite() && found.fit.validation_rms.is_finite(), "{}", found.summary);
    assert!(found.suggestions.is_empty() || found.verdict == Verdict::MissingEffect, "{}", found.summary);
    for s in &found.suggestions {
        assert!(s.p_value <= 0.05 && s.validation_rms.is_finite(), "{s:?}");
    }
    let drawn = found.regions.iter().all(|r| r.mean_residual.is_finite() && r.from <= r.to && r.samples > 0);
    assert!(drawn, "{:?}", found.regions);
    assert!(!found.summary.contains("NaN") && !found.summary.contains("inf"), "{}", found.summary);
}

/// Every effect that is not in the model is reported once: suggested, silent, not visible or rejected. With
/// contradictory columns that make every fit meaningless, none is.
fn assert_each_reported_once(found: &Diagnosis, spec: &ModelSpec) {
    let times_reported = |effect: &str| {
        found.suggestions.iter().filter(|s| s.effect == effect).count()
            + found.silent.iter().filter(|s| s.effect == effect && s.minimum_detectable_rms.is_finite()).count()
            + found.not_visible.iter().filter(|s| s.effect == effect && s.why.len() > 10).count()
            + found.left_out.iter().filter(|s| s.effect == effect && s.why.len() > 10).count()
    };
    let candidates = spec.known().map(|effect| effect.info().id).filter(|id| !spec.contains(id));
    let times: Vec<(&str, usize)> = candidates.map(|effect| (effect, times_reported(effect))).collect();
    let is_untested = found.undecided_reason == Some(UndecidedReason::ContradictoryColumns)
        && times.iter().all(|(_, times)| *times == 0);
    assert!(is_untested || times.iter().all(|(_, times)| *times == 1), "{}: {times:?}", spec.kind);
}

/// Five speeds in both directions, with ramps of 0.4 s.
fn with_ramps() -> RunTable {
    let names = ["time_s", "motor_position_rad", "motor_velocity_rad_s", "motor_current_a", "segment", "repeat"];
    let mut trace = Trace::new(names.map(Channel::new).into());
    let (mut position, mut before) = (0.0, 0.0);
    for leg in 0..40 {
        let target = [2.0, 3.0, 4.5, 6.0, 9.0][leg / 2 % 5] * if leg % 2 == 0 { 1.0 } else { -1.0 };
        for k in 0..300 {
            let i = leg * 300 + k;
            let velocity: f64 = before + (target - before) * (k as f64 / 100.0).min(1.0);
            position += 0.004 * velocity;
            let torque = 0.03 * velocity.signum() + 1e-3 * velocity + 2e-3 * scatter(i, 5);
            trace.push_row(&[0.004 * i as f64, position, velocity, torque / 0.08, leg as f64, (leg / 10) as f64]);
        }
        before = target;
    }
    RunTable::new(meta(), trace).unwrap()
}

#[test]
fn no_effect_is_forgotten() {
    let run = with_ramps();
    let spec = ModelSpec::parse(Kind::Friction, "coulomb,viscous").unwrap();
    let found = diagnose(&run, &spec, &Options::default()).unwrap();
    assert_each_reported_once(&found, &spec);
    assert!(found.silent.iter().any(|s| s.effect == "presliding" && s.minimum_detectable_rms > 0.0), "{found:?}");
    let reported =
        |id: &str| found.not_visible.iter().find(|n| n.effect == id).map(|n| n.why.as_str()).unwrap_or_default();
    assert!(reported("signal_delay").contains("Ramps"), "{}", reported("signal_delay"));

    let one_way = |name: &str, i: usize, v: f64| match name {
        "reference_position_rad" => 0.01 * i as f64,
        "test_position_rad" => 0.01 * i as f64 + 1e-4 * scatter(i, 3),
        _ => v,
    };
    let run = try_table(Kind::Encoder, &Shape { segment: 250, repeats: 3, ..Shape::default() }, one_way).unwrap();
    let spec = ModelSpec::baseline(&run).unwrap();
    let found = diagnose(&run, &spec, &Options::default()).unwrap();
    assert_each_reported_once(&found, &spec);
    let reported = found.not_visible.iter().find(|n| n.effect == "direction_hysteresis");
    assert!(
        reported.is_some_and(|n| n.why.contains("indistinguishable in this data from effects of the model")),
        "{reported:?}"
    );

    for kind in Kind::ALL {
        let run = common::tables::table(kind, &Shape { segment: 300, repeats: 3, ..Shape::default() });
        let spec = ModelSpec::baseline(&run).unwrap();
        assert_each_reported_once(&diagnose(&run, &spec, &Options::default()).unwrap(), &spec);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn no_table_of_any_kind_makes_it_panic(
        kind in prop::sample::select(Kind::ALL.to_vec()),
        rows in 1usize..900,
        size in prop::sample::select(vec![0.0, 1e-12, 1.0, 1e9, 1e150]),
        turn in prop::sample::select(vec![0.0, 1e-6, 0.3, 40.0, 1e9]),
        noise in prop::sample::select(vec![0.0, 1e-3, 1.0, 100.0]),
        segment in prop::sample::select(vec![0usize, 1, 7, 100, 1000]),
        repeats in 1usize..5,
        mix in 0u64..1000,
    ) {
        let shape = Shape { rows, turn, size, noise, mix, segment, repeats };
        let run = common::tables::table(kind, &shape);
        let given = ModelSpec::baseline(&run).unwrap();
        // Models with more than the baseline may fail differently.
        let more = given.known().map(|effect| effect.info().id).filter(|id| !given.contains(id));
        let every = mix as usize % 5 + 1;
        let spec = ModelSpec::new(kind, given.effects.iter().map(String::as_str).chain(more.skip(every).step_by(every))).unwrap();
        if let Ok(found) = diagnose(&run, if mix % 2 == 0 { &given } else { &spec }, &Options::default()) {
            assert_finite(&found);
            assert_each_reported_once(&found, if mix % 2 == 0 { &given } else { &spec });
            let drawn = maps(&run, &found.fit, &Options::default()).unwrap();
            prop_assert!(drawn.axes.iter().flat_map(|a| &a.bins).all(|b| b.mean.is_finite() && b.rows > 0));
        }
    }
}
