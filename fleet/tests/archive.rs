//! Files that are damaged, foreign, doubled or different are named or counted, never misread.

mod common;

use common::{Run, table};
use datafusion::arrow::array::AsArray;
use datafusion::arrow::datatypes::{Float64Type, Int64Type};
use jointbench_fleet::Fault;
use jointbench_fleet::archive::{Archive, Content, Inventory, Selection};
use jointbench_fleet::compact::compact;
use jointbench_fleet::fit::{fit, model};
use jointbench_fleet::query::{answer, json};
use jointbench_instrument::{Channel, Trace};
use std::fs;
use std::path::Path;

fn open(folder: &Path) -> Archive {
    Archive::open(&folder.display().to_string()).unwrap()
}

fn run(number: usize) -> Run {
    Run { serial: format!("SN{number}"), number, ..Run::default() }
}

/// Three runs.
fn filled(folder: &Path) {
    for number in 1..=3 {
        run(number).write(folder, &table(0.03, 8e-4, 0.0, number as u64));
    }
}

fn count(folder: &Path, selection: &Selection) -> Result<i64, Fault> {
    let found = answer(&open(folder), selection, 2, "SELECT count(*) AS n, sum(time_s) FROM means")?;
    Ok(found.batches[0].column(0).as_primitive::<Int64Type>().value(0))
}

const SKIP: Selection = Selection { part: None, skip_damaged: true, omitted: Vec::new() };

#[test]
fn truncated_foreign_and_corrupted_files_are_refused_by_name_and_omitted_on_request() {
    let folder = tempfile::tempdir().unwrap();
    filled(folder.path());
    let path = run(4).write(folder.path(), &table(0.03, 8e-4, 0.0, 4));
    let whole = fs::read(&path).unwrap();
    let mut flipped = whole.clone();
    flipped[60..400].iter_mut().for_each(|byte| *byte ^= 0x5a);
    let foreign = b"PAR1 a text and no table PAR1".to_vec();
    for (what, bytes) in [("cut", whole[..whole.len() / 2].to_vec()), ("foreign", foreign), ("flipped", flipped)] {
        fs::write(&path, bytes).unwrap();
        let refused = count(folder.path(), &Selection::default()).unwrap_err();
        let text = refused.to_string();
        assert!(refused.exit_code() == 2 && text.contains("run-5f0c91d2aa03b7e4-4.parquet"), "{what}: {text}");
        assert!(text.contains("--skip-damaged"), "{what}: {text}");
        assert_eq!(count(folder.path(), &SKIP).unwrap(), 3 * 48, "{what}");
        let fitted = fit(&open(folder.path()), &SKIP, &model("coulomb + viscous").unwrap(), 2).unwrap();
        assert_eq!((fitted.units.len(), fitted.omitted.damaged.len()), (3, 1), "{what}");
    }
}

#[test]
fn data_that_differ_from_their_digest_are_damaged() {
    let folder = tempfile::tempdir().unwrap();
    filled(folder.path());
    let path = run(2).write(folder.path(), &table(0.03, 8e-4, 0.0, 2));
    let mut bytes = fs::read(&path).unwrap();
    let digest = b"jointbench.sha256";
    let at = bytes.windows(digest.len()).position(|window| window == digest).unwrap() + digest.len() + 5;
    bytes[at] = if bytes[at] == b'0' { b'1' } else { b'0' };
    fs::write(&path, bytes).unwrap();
    let archive = open(folder.path());
    for text in [
        compact(&archive, &Selection::default()).unwrap_err().to_string(),
        fit(&archive, &Selection::default(), &model("stribeck").unwrap(), 2).unwrap_err().to_string(),
    ] {
        assert!(text.contains("-2.parquet: its data have the SHA-256"), "{text}");
    }
    assert_eq!(archive.files(Content::Means).unwrap().len(), 3, "nothing is removed");
}

#[test]
fn another_program_or_layout_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    filled(folder.path());
    let other = folder.path().join("means/other.parquet");
    let trace = Trace::from_columns(vec![Channel::new("x")], vec![vec![1.0]]);
    jointbench_files::write_parquet(fs::File::create(&other).unwrap(), &Run::meta(), &trace).unwrap();
    let refused = Inventory::read(&open(folder.path()), Content::Means, &Selection::default()).unwrap_err();
    assert!(refused.to_string().contains("other.parquet: no file of jointbench"), "{refused}");
}

#[test]
fn a_run_counts_once_and_other_data_under_its_name_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    filled(folder.path());
    let copy = folder.path().join("means/copy.parquet");
    run(2).write_to(&copy, &table(0.03, 8e-4, 0.0, 2));
    assert_eq!(count(folder.path(), &Selection::default()).unwrap(), 3 * 48);
    let fitted = fit(&open(folder.path()), &Selection::default(), &model("coulomb").unwrap(), 2).unwrap();
    assert_eq!((fitted.units.len(), fitted.omitted.duplicates), (3, 1));
    run(2).write_to(&copy, &table(0.03, 8e-4, 0.0, 99));
    let refused = count(folder.path(), &Selection::default()).unwrap_err().to_string();
    assert!(
        refused.contains("copy.parquet") && refused.contains("-2.parquet") && refused.contains("run 2"),
        "{refused}"
    );
}

#[test]
fn the_latest_completed_run_represents_a_unit() {
    let folder = tempfile::tempdir().unwrap();
    let write = |number: usize, serial: &str, state: &'static str, at: &str, coulomb: f64| {
        let run = Run { serial: serial.into(), number, state, created_at: at.into(), ..Run::default() };
        run.write(folder.path(), &table(coulomb, 8e-4, 0.0, number as u64));
    };
    write(1, "A", "completed", "2026-03-02T08:00:00Z", 0.02);
    write(2, "A", "completed", "2026-03-02T09:00:00Z", 0.03);
    write(3, "A", "aborted", "2026-03-02T10:00:00Z", 0.04);
    let fitted = fit(&open(folder.path()), &Selection::default(), &model("coulomb + viscous").unwrap(), 2).unwrap();
    assert_eq!((fitted.omitted.earlier_runs, fitted.omitted.not_completed), (1, 1));
    assert!((fitted.units[0].parameters[0].value - 0.03).abs() < 1e-3, "{:?}", fitted.units);
}

#[test]
fn files_with_different_columns_are_one_table() {
    let folder = tempfile::tempdir().unwrap();
    filled(folder.path());
    let (mut channels, mut columns) = table(0.03, 8e-4, 0.0, 4).into_parts();
    channels.push(Channel::new("humidity_percent"));
    columns.push(vec![40.0; 48]);
    run(4).write(folder.path(), &Trace::from_columns(channels, columns));
    let sql = "SELECT serial, part, batch, bench, store, count(*) AS n, count(humidity_percent) AS humid, \
               max(torque_constant_nm_per_a) AS km FROM means GROUP BY ALL ORDER BY serial";
    let sql = sql.replace("GROUP BY ALL", "GROUP BY serial, part, batch, bench, store");
    let before = json(&answer(&open(folder.path()), &Selection::default(), 2, &sql).unwrap().batches).unwrap();
    assert!(before.contains(r#""serial":"SN4","part":"JA-100","batch":"B1","bench":"eol-1""#), "{before}");
    assert!(before.contains(r#""n":48,"humid":48,"km":0.1"#) && before.contains(r#""n":48,"humid":0"#), "{before}");

    compact(&open(folder.path()), &Selection::default()).unwrap();
    let after = json(&answer(&open(folder.path()), &Selection::default(), 2, &sql).unwrap().batches).unwrap();
    assert_eq!(after, before);
}

#[test]
fn a_compacted_archive_has_the_same_answers_and_the_provenance_of_each_run() {
    let folder = tempfile::tempdir().unwrap();
    filled(folder.path());
    let archive = open(folder.path());
    let spec = model("coulomb + viscous + stribeck").unwrap();
    let sources = |archive: &Archive| -> Vec<_> {
        let found = Inventory::read(archive, Content::Means, &Selection::default()).unwrap();
        found.sources().cloned().collect()
    };
    let (before, fitted) = (sources(&archive), fit(&archive, &Selection::default(), &spec, 2).unwrap());
    let kept = fs::read(archive.files(Content::Means).unwrap().remove(1)).unwrap();
    let done = compact(&archive, &Selection::default()).unwrap();
    assert_eq!((done.runs, done.files_before, done.files_after), (3, 3, 1));
    assert_eq!(sources(&archive), before);
    let again = fit(&archive, &Selection::default(), &spec, 2).unwrap();
    assert_eq!(serde_json::to_string(&again).unwrap(), serde_json::to_string(&fitted).unwrap());

    // A late run joins; an old file that an interruption has left is counted once and removed.
    run(4).write(folder.path(), &table(0.03, 8e-4, 0.0, 4));
    let left = folder.path().join("means/part=JA-100/batch=B1/bench=eol-1/run-5f0c91d2aa03b7e4-2.parquet");
    fs::write(&left, kept).unwrap();
    assert_eq!(count(folder.path(), &Selection::default()).unwrap(), 4 * 48);
    let done = compact(&archive, &Selection::default()).unwrap();
    assert_eq!((done.runs, done.files_before, done.files_after, done.duplicates_removed), (4, 3, 1, 1));
    assert_eq!(archive.files(Content::Means).unwrap().len(), 1);
    assert_eq!(count(folder.path(), &Selection::default()).unwrap(), 4 * 48);
    let nothing = compact(&archive, &Selection::default()).unwrap();
    assert_eq!((nothing.files_before, nothing.files_after), (1, 1));
}

#[test]
fn sql_is_checked_and_gram_merges_over_files() {
    let folder = tempfile::tempdir().unwrap();
    filled(folder.path());
    let ask = |sql: &str, threads| answer(&open(folder.path()), &Selection::default(), threads, sql);
    for wrong in ["SELEC 1", "SELECT no_such_column FROM means", "SELECT gram(time_s) FROM means"] {
        assert_eq!(ask(wrong, 1).err().map(|fault| fault.exit_code()), Some(2), "{wrong}");
    }
    let sql = "SELECT gram(motor_current_a, motor_velocity_rad_s, regressor('coulomb', motor_velocity_rad_s)) AS gram, \
               count(*) AS n, avg(motor_current_a) AS mean, var_pop(motor_current_a) AS variance FROM means";
    let of = |threads: usize| -> Vec<f64> {
        let found = ask(sql, threads).unwrap();
        let row = &found.batches[0];
        let gram = row.column(0).as_list::<i32>().value(0).as_primitive::<Float64Type>().values().to_vec();
        let number = |k: usize| row.column(k).as_primitive::<Float64Type>().value(0);
        assert_eq!(gram[0], row.column(1).as_primitive::<Int64Type>().value(0) as f64);
        assert!((gram[1] - number(2)).abs() < 1e-12 && (gram[4] / gram[0] - number(3)).abs() < 1e-12, "{gram:?}");
        gram
    };
    let (one, three) = (of(1), of(3));
    one.iter().zip(&three).for_each(|(a, b)| assert!((a - b).abs() <= 1e-9 * a.abs().max(1e-6), "{one:?} {three:?}"));
}
