//! A unit's figure of the fleet equals the daemon's own for that unit.

mod common;

use common::{Fleet, Run, table, write};
use jointbench_files::{ReadOptions, read};
use jointbench_fleet::archive::{Archive, Selection};
use jointbench_fleet::fit::{FleetFit, UnitFit, fit, model};
use jointbench_model::{Options, ParameterState, diagnose};
use std::path::Path;

fn open(folder: &Path) -> Archive {
    Archive::open(&folder.display().to_string()).unwrap()
}

fn fitted(folder: &Path, effects: &str) -> FleetFit {
    fit(&open(folder), &Selection::default(), &model(effects).unwrap(), 2).unwrap()
}

/// The fit of the daemon to a file of the archive.
fn daemon(file: &Path, effects: &str) -> jointbench_model::Fit {
    let run = read(file, &ReadOptions::default()).unwrap();
    jointbench_model::fit(&run, &model(effects).unwrap(), &Options::default()).unwrap()
}

fn is_close(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= 1e-9 * a.abs().max(b.abs())
}

fn assert_equal(unit: &UnitFit, own: &jointbench_model::Fit) {
    assert_eq!(unit.rows, own.preparation.rows);
    assert!(is_close(unit.rms, own.rms), "{} {}", unit.rms, own.rms);
    assert_eq!((unit.parameters.len(), &unit.rms_unit), (own.parameters.len(), &own.unit));
    for (found, own) in unit.parameters.iter().zip(&own.parameters) {
        assert_eq!((&found.effect, &found.name, &found.unit), (&own.effect, &own.name, &own.unit));
        let same = is_close(found.value, own.value) && (0..2).all(|k| is_close(found.ci95[k], own.ci95[k]));
        assert!(same, "{}: {found:?} {own:?}", unit.unit.serial);
    }
}

#[test]
fn every_model_from_gram_matrices_and_from_rows_is_the_fit_of_the_daemon() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = Fleet { batches: 2, units_per_batch: 4, stribeck_share: 0.25, ..Fleet::default() };
    let truth = write(folder.path(), &fleet);
    let models = [
        "coulomb + viscous",
        "coulomb, viscous, direction_offset, viscous_asymmetry",
        "coulomb + viscous + stribeck",
        "coulomb + temperature_coulomb",
    ];
    for effects in models {
        let found = fitted(folder.path(), effects);
        assert_eq!((found.units.len(), found.refused.len()), (8, 0), "{effects}");
        for (unit, file) in found.units.iter().zip(&truth.files) {
            assert_equal(unit, &daemon(file, effects));
        }
    }
}

#[test]
fn a_unit_that_gram_matrices_cannot_decide_has_the_answer_of_the_daemon() {
    let folder = tempfile::tempdir().unwrap();
    let one_way = {
        let whole = table(0.03, 8e-4, 0.0, 5);
        let rows: Vec<usize> = (0..whole.len()).filter(|row| whole.columns()[4][*row] > 0.0).collect();
        let columns = whole.columns().iter().map(|column| rows.iter().map(|row| column[*row]).collect()).collect();
        jointbench_instrument::Trace::from_columns(whole.channels().to_vec(), columns)
    };
    let file = Run { serial: "ONE-WAY".into(), ..Run::default() }.write(folder.path(), &one_way);
    let mut short = table(0.03, 8e-4, 0.0, 6);
    let columns = short.columns().iter().map(|column| column[..10].to_vec()).collect();
    short = jointbench_instrument::Trace::from_columns(short.channels().to_vec(), columns);
    Run { serial: "SHORT".into(), number: 2, ..Run::default() }.write(folder.path(), &short);

    let effects = "coulomb + direction_offset";
    let found = fitted(folder.path(), effects);
    assert_eq!((found.units.len(), found.refused.len()), (1, 1));
    assert_equal(&found.units[0], &daemon(&file, effects));
    assert_eq!(found.units[0].parameters[1].value, 0.0, "not visible in one direction");
    assert_eq!(found.refused[0].unit.serial, "SHORT");
    assert!(found.refused[0].reason.contains("10"), "{}", found.refused[0].reason);
}

#[test]
fn points_at_rest_are_omitted_as_in_the_daemon() {
    let folder = tempfile::tempdir().unwrap();
    let (channels, mut columns) = table(0.03, 8e-4, 0.0, 5).into_parts();
    (columns[4][3], columns[5][3]) = (1e-4, 5.0);
    let file = Run::default().write(folder.path(), &jointbench_instrument::Trace::from_columns(channels, columns));
    let found = fitted(folder.path(), "coulomb + viscous");
    assert_eq!(found.units[0].rows, 47);
    assert_equal(&found.units[0], &daemon(&file, "coulomb + viscous"));
}

#[test]
fn the_diagnosis_of_a_unit_is_that_of_the_daemon() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = Fleet { batches: 1, units_per_batch: 12, stribeck_share: 0.25, ..Fleet::default() };
    let truth = write(folder.path(), &fleet);
    let spec = model("coulomb + viscous").unwrap();
    let found = jointbench_fleet::diagnose::diagnose(&open(folder.path()), &Selection::default(), &spec).unwrap();
    assert_eq!(found.units.len(), 12);
    for ((unit, fit), file) in found.units.iter().zip(&found.fit.units).zip(&truth.files) {
        let run = read(file, &ReadOptions::default()).unwrap();
        let own = diagnose(&run, &spec, &Options::default()).unwrap();
        let missing: Vec<String> = own.suggestions.iter().map(|suggestion| suggestion.effect.clone()).collect();
        assert_eq!(unit.missing, missing, "{}", unit.unit.serial);
        assert!(own.fit.parameters.iter().all(|p| p.state == ParameterState::Ok));
        assert_equal(fit, &own.fit);
    }
}
