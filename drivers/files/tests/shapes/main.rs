//! One recording in the formats of other laboratories' tools: read correctly, or refused with the option that reads it.
//!
//! `make.py` writes the files; pandas, polars and NumPy write their own formats themselves.

mod mutations;
mod texts;

use jointbench_files::{Choices, FileError, Note, ReadOptions, understand};
use jointbench_instrument::{Kind, Meta, RunTable};
use std::path::{Path, PathBuf};

/// Questions that the file does not answer: the option that the refusal must name, and the choices that read the file.
fn options() -> Vec<(&'static str, &'static str, Choices)> {
    let names = Some("time_s,motor_position_rad,motor_velocity_rad_s,motor_current_a".to_owned());
    let named = Choices { names, ..Choices::default() };
    let unit = Choices { unit: vec!["time_s=ms".into()], ..Choices::default() };
    let comma = Choices { decimal: vec!["motor_current [mA]=comma".into()], ..Choices::default() };
    vec![
        ("numpy_bare.txt", "--names time,column_2,column_3,column_4", named.clone()),
        ("matlab_bare.csv", "--names time,column_2,column_3,column_4", named),
        ("arduino_millis.csv", "--unit time_s=ms", unit),
        ("mixed_signs.csv", "--decimal 'motor_current [mA]=comma'", comma),
    ]
}

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/shapes/written");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

fn take(path: &Path, choices: &Choices) -> Result<(RunTable, Vec<Note>), FileError> {
    let meta = Some(Meta { kind: Some(Kind::Friction), ..Meta::default() });
    understand(path, &ReadOptions { meta, ..choices.options().unwrap() })?.into_run()
}

/// A column: name, value in a row, and tolerance of the written value.
type Truth = (&'static str, fn(f64) -> f64, f64);

/// The recording of `make.py`.
fn truth() -> [Truth; 4] {
    [
        ("time_s", |i| 0.005 * i, 1e-6),
        ("motor_position_rad", |i| 2.5 * (0.2 * i).sin(), 6e-4),
        ("motor_velocity_rad_s", |i| 100.0 * (0.2 * i).cos(), 6e-4),
        ("motor_current_a", |i| 1.2 + 0.8 * (0.2 * i).cos(), 6e-4),
    ]
}

/// The first error of an imported table.
fn wrong(run: &RunTable) -> Option<String> {
    if !(39..=40).contains(&run.len()) {
        return Some(format!("{} rows", run.len()));
    }
    truth().into_iter().find_map(|(name, value, off)| {
        let Some(column) = run.column(name) else { return Some(format!("{name} is missing")) };
        let row = column.iter().enumerate().find(|(row, found)| (*found - value(*row as f64)).abs() > off)?;
        Some(format!("{name} is {} in row {}, not {}", row.1, row.0, value(row.0 as f64)))
    })
}

#[test]
fn usual_shapes_are_read_right_or_name_the_option() {
    let options = options();
    let (mut right, mut problems) = (0, Vec::new());
    for path in files() {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let choices = options.iter().find(|(of, _, _)| *of == name);
        match (take(&path, &Choices::default()), choices) {
            (Ok((run, _)), None) => match wrong(&run) {
                None => right += 1,
                Some(wrong) => problems.push(format!("{name} is read wrong: {wrong}")),
            },
            (Ok(_), Some(_)) => problems.push(format!("{name} is read without a question")),
            (Err(refused), None) => problems.push(format!("{refused}")),
            (Err(refused), Some((_, option, choices))) => {
                if !refused.to_string().contains(option) {
                    problems.push(format!("{refused}: {option} is not named"));
                }
                match take(&path, choices) {
                    Err(refused) => problems.push(format!("{refused}, with {choices:?}")),
                    // The mixed table has other numbers.
                    Ok((run, _)) if name != "mixed_signs.csv" => problems.extend(wrong(&run)),
                    Ok((run, _)) => assert_eq!(run.column("motor_current_a").unwrap()[0], 1.2),
                }
            }
        }
    }
    println!("{right} files are read without an option, {} say it", options.len());
    assert!(problems.is_empty(), "{}", problems.join("\n"));
    assert!(right >= 57, "{right}");
}

#[test]
fn skipped_and_assumed_parts_are_noted() {
    let message = |name: &str| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/shapes/written");
        jointbench_files::paragraph(&take(&folder.join(name), &Choices::default()).unwrap().1)
    };
    for (name, words) in [
        ("pandas_plain.csv", &[][..]),
        ("pandas_index.csv", &["the first column counts the rows and is omitted"]),
        ("csv_comments.csv", &["2 comment lines above the names skipped"]),
        ("csv_units_line.csv", &["line 2 was taken as units"]),
        ("pandas_german.csv", &["numbers have a decimal comma (--decimal point)"]),
        (
            "calc_units_latin1.csv",
            &["read as windows-1252", "“motor_position_rad” is “Motor Position [°]”, converted from °"],
        ),
        (
            "pandas_gaps.csv",
            &[
                "column “remark” is omitted: it holds words",
                "column “oil_temperature” is omitted: 30 of 40 cells are empty",
            ],
        ),
        ("pandas_bool.csv", &["“valid” is 1 for true and 0 for false (--leave valid)"]),
        ("csv_cut_off.csv", &["truncated and omitted"]),
        ("labview.lvm", &["no row has a value for “Comment”", "“time_s” has no unit and was taken as s"]),
        ("epoch_ms.csv", &["“time_s” has no unit and was taken as ms, since 1970"]),
        ("pandas_datetime.csv", &["“time_s” counts the seconds from the stamp in the first row, 2026-01-02 10:00:00"]),
        ("named_again.csv", &["the line of names is repeated 1 time between the rows"]),
    ] {
        let message = message(name);
        assert!(words.iter().all(|word| message.contains(word)), "{name}: {message}");
        assert_eq!(words.is_empty(), message.is_empty(), "{name}: {message}");
    }
}
