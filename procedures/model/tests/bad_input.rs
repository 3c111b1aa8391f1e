//! A clear verdict or error on whatever a run may hold, never a panic, never a suggestion out of nothing.

mod common;

use common::bench::meta;
use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use jointbench_model::{ModelError, ModelSpec, Options, diagnose, fit};
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

/// Scatter without any order.
fn scatter(i: usize) -> f64 {
    ((i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / (1u64 << 24) as f64 - 0.5
}

#[test]
fn one_direction_at_one_speed_names_what_cannot_be_told_apart() {
    let run = table(500, |i| 1.0 + 0.01 * scatter(i), |i| i as f64 * 0.1);
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
    let run = table(500, |_| 1.0, |i| (i as f64 * 0.05).sin());
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
    assert!(found.notes.iter().any(|n| n.contains("load_linear is not visible")), "{:?}", found.notes);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_table_makes_it_panic(
        rows in 1usize..600,
        size in prop::sample::select(vec![0.0, 1e-12, 1.0, 1e9]),
        turn in prop::sample::select(vec![0.0, 0.001, 0.3, 40.0]),
        mix in 0u64..1000,
    ) {
        let jitter = |i: usize| ((i as u64 * 2654435761 + mix) % 1000) as f64 / 1000.0 - 0.5;
        let run = table(rows, |i| size * jitter(i), |i| turn * (i as f64 * 0.05).sin() + 1e-3 * turn * jitter(i + 7));
        let _ = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default());
    }
}
