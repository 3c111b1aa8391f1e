//! An unknown column is an axis: structure that depends on it is reported over it.

mod common;

use common::bench::Staircase;
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::export::{Format, OnlinePrediction, export};
use jointbench_model::{
    Diagnosis, Fit, ModelSpec, Options, UserEffect, Verdict, diagnose, evaluate, fit, maps, residuals,
};

const COLUMN: &str = "oil_pressure_pa";

/// Another pressure in each step of 0.6 s.
fn pressure_pa(time_s: f64) -> f64 {
    let step = ((time_s - 1e-6) / 0.6) as u64;
    1e5 + 2e4 * (step.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 61) as f64
}

/// A staircase with an additional column, and `nm` more torque in the middle of its range.
fn run(column: &str, nm: f64) -> RunTable {
    run_with(column, |_| nm)
}

/// The same with a torque that may depend on the direction.
fn run_with(column: &str, nm: impl Fn(f64) -> f64) -> RunTable {
    let steps = Staircase { noise_nm: 2e-3, scatter_nm: 1e-4, seed: 3 }.run(|m| {
        let middle = (1.5e5..1.9e5).contains(&pressure_pa(m.time));
        (0.03 + 2e-4 * m.velocity.abs()) * m.velocity.signum() + if middle { nm(m.velocity.signum()) } else { 0.0 }
    });
    let (meta, trace) = steps.into_parts();
    let names = trace.channels().iter().map(|c| c.name.clone()).chain([column.to_owned()]);
    let mut with = Trace::new(names.map(Channel::new).collect());
    for row in 0..trace.column("time_s").unwrap().len() {
        let known = trace.channels().iter().map(|c| trace.column(&c.name).unwrap()[row]);
        with.push_row(&known.chain([pressure_pa(trace.column("time_s").unwrap()[row])]).collect::<Vec<_>>());
    }
    RunTable::new(meta, with).unwrap()
}

fn diagnosed(run: &RunTable) -> Diagnosis {
    diagnose(run, &ModelSpec::baseline(run).unwrap(), &Options::default()).unwrap()
}

#[test]
fn structure_over_an_unknown_column_is_reported_over_it() {
    let run = run(COLUMN, 3e-3);
    let found = diagnosed(&run);
    assert_eq!(found.verdict, Verdict::UnexplainedStructure, "{}", found.summary);
    assert!(found.shows_over.iter().any(|axis| axis == COLUMN), "{:?}", found.shows_over);
    assert!(found.summary.contains("oil pressure"), "{}", found.summary);
    assert!(found.regions[0].axis == COLUMN && found.regions[0].sentence.contains("Pa"), "{:?}", found.regions);

    let fitted = fit(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
    let drawn = maps(&run, &fitted, &Options::default()).unwrap();
    assert!(drawn.axes.iter().any(|map| map.axis == COLUMN && map.unit == "Pa" && map.removable_share > 0.5));
    let set = residuals(&run, &fitted, &Options::default()).unwrap();
    let axis = set.axes.iter().find(|axis| axis.name == COLUMN).unwrap();
    assert_eq!((axis.values.len(), axis.unit.as_str()), (set.error.len(), "Pa"));
}

#[test]
fn friction_that_grows_with_an_unknown_column_is_reported_too() {
    // Over the column alone both directions cancel, and as no two repeats have the same pressure it would count as
    // noise.
    let found = diagnosed(&run_with(COLUMN, |sign| 6e-3 * sign));
    assert_eq!(found.verdict, Verdict::UnexplainedStructure, "{}", found.summary);
    assert!(found.summary.contains("oil pressure and direction"), "{}", found.summary);
}

#[test]
fn a_column_that_moves_nothing_is_no_cause() {
    let found = diagnosed(&run(COLUMN, 0.0));
    assert_eq!(found.verdict, Verdict::Adequate, "{}", found.summary);
}

#[test]
fn the_effort_of_the_drive_is_no_axis() {
    for column in ["bus_current_a", "other_torque_nm", "output_position_rad", "torque_skew_s", "state"] {
        let run = run(column, 0.0);
        let fitted = fit(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
        let drawn = maps(&run, &fitted, &Options::default()).unwrap();
        assert!(drawn.axes.iter().all(|map| map.axis != column), "{column}");
    }
}

/// Torque in the middle of the pressures only, as a user formula.
const MIDDLE: &str = "middle: tau = a * direction * max(0, sign(2e4 - abs(column(oil_pressure_pa) - 1.7e5))); a [Nm]";

#[test]
fn a_formula_over_the_column_takes_it_off() {
    let (run, other) = (run_with(COLUMN, |sign| 6e-3 * sign), run_with("spare_v", |_| 0.0));
    let own = vec![UserEffect::inline(Kind::Friction, MIDDLE).unwrap()];
    let baseline = run.meta().baseline.clone();
    let spec = ModelSpec::with_user_effects(Kind::Friction, baseline.iter().cloned(), own.clone()).unwrap();
    let found = diagnose(&run, &spec, &Options::default()).unwrap();
    assert_eq!(found.suggestions.first().map(|s| s.effect.as_str()), Some("middle"), "{}", found.summary);

    let effects = baseline.into_iter().chain(["middle".to_owned()]);
    let spec = ModelSpec::with_user_effects(Kind::Friction, effects, own).unwrap();
    let fitted = fit(&run, &spec, &Options::default()).unwrap();
    let a = fitted.parameters.iter().find(|p| p.name == "a").unwrap();
    assert!((a.value - 6e-3).abs() < 6e-4 && a.unit == "Nm", "{a:?}");
    let range = fitted.scope.as_ref().unwrap().signals.iter().find(|s| s.name == COLUMN).unwrap();
    assert_eq!((range.min, range.max, range.unit.as_str()), (1e5, 2.4e5, "Pa"));

    let again: Fit = serde_json::from_str(&serde_json::to_string(&fitted).unwrap()).unwrap();
    assert!((evaluate(&again, &run).unwrap().rms / fitted.rms - 1.0).abs() < 1e-6);
    assert!(export(&fitted, Format::C).unwrap().contains("double oil_pressure_pa;"));
    let table = export(&fitted, Format::Table).unwrap();
    assert!(table.contains("oil_pressure_pa = 170000 Pa"), "{table}");

    // During a run the column is read row by row; without it there is no prediction.
    let (kt, gear) = (run.meta().torque_constant_nm_per_a.unwrap(), run.meta().gear_ratio.unwrap());
    let live = || OnlinePrediction::new(fitted.clone(), kt, gear).unwrap();
    let [measured, model] = live().push(run.trace()).unwrap();
    let left = measured.iter().zip(&model).map(|(m, p)| (m - p).powi(2)).sum::<f64>() / measured.len() as f64;
    assert!(left.sqrt() < 4e-3, "{}", left.sqrt());
    assert!(live().push(other.trace()).is_none());

    let without = fit(&other, &spec, &Options::default()).unwrap();
    let text = "middle is not testable with this run: the run has no column oil_pressure_pa";
    assert!(without.notes.iter().any(|note| note == text), "{:?}", without.notes);
}
