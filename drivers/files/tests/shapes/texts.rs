//! Small texts: numbers, times and names that are ambiguous.

use jointbench_files::{Choices, FileError, Note, ReadOptions, understand_bytes};
use jointbench_instrument::{Kind, Meta, RunTable};

fn take(text: &str, choices: &Choices) -> Result<(RunTable, Vec<Note>), FileError> {
    let meta = Some(Meta { kind: Some(Kind::Friction), ..Meta::default() });
    understand_bytes("run.csv", text.as_bytes(), &ReadOptions { meta, ..choices.options().unwrap() })?.into_run()
}

fn column(text: &str, name: &str) -> Vec<f64> {
    let (run, _) = take(text, &Choices::default()).unwrap_or_else(|refused| panic!("{refused}\n{text}"));
    run.column(name).unwrap().to_vec()
}

#[track_caller]
fn refused(text: &str, words: &[&str]) {
    let message = take(text, &Choices::default()).unwrap_err().to_string();
    assert!(words.iter().all(|word| message.contains(word)), "{message}");
}

/// A table with a time, a position and one more column.
fn table(name: &str, cells: &[&str]) -> String {
    let rows = cells.iter().enumerate().map(|(row, cell)| format!("{},5;0,{row};{cell}\n", row));
    format!("time_s;motor_position_rad;{name}\n{}", rows.collect::<String>())
}

#[test]
fn no_number_is_silently_wrong_by_a_thousand() {
    let grouped = table("motor_current_a", &["1.220,5", "998", "1.204"]);
    assert_eq!(column(&grouped, "motor_current_a"), [1220.5, 998.0, 1204.0]);
    let doubtful = table("motor_current_a", &["1.220", "1.210", "1.238"]);
    refused(
        &doubtful,
        &[
            "run.csv, line 2, column motor_current_a",
            "“1.220” is 1.22 where the point stands before decimals, and 1220 where it parts thousands",
            "--decimal motor_current_a=point or --decimal motor_current_a=comma",
        ],
    );
    for (word, value) in [("point", 1.22), ("comma", 1220.0)] {
        let choices = Choices { decimal: vec![format!("motor_current_a={word}")], ..Choices::default() };
        assert_eq!(take(&doubtful, &choices).unwrap().0.column("motor_current_a").unwrap()[0], value);
    }
    let decimal = table("motor_current_a", &["1.5", "2.25", "1.125"]);
    refused(&decimal, &["expected a number, found “1.5”: it is one with --decimal NAME=point"]);
    // Whole numbers below a thousand, and points in all larger numbers.
    let points = "time_s,motor_position_rad,motor_current_a\n0.1,0.5,998\n0.2,0.5,1.002\n0.3,0.5,1.004\n";
    refused(points, &["line 3, column motor_current_a", "“1.002” is 1.002 where the point"]);
    let quoted = "time_s,motor_position_rad,motor_current_a\n0.1,0.5,\"1,220\"\n0.2,0.5,\"1,210\"\n";
    refused(quoted, &["“1,220” is 1.22 where the comma", "--decimal motor_current_a=comma"]);
    let only = "time_s;motor_position_rad;motor_current_a\n1;1,500;1,220\n2;1,500;1,210\n";
    refused(only, &["“1,500” is 1.5 where the comma"]);
    assert_eq!(column(&quoted.replace("1,210", "1,210.5"), "motor_current_a"), [1220.0, 1210.5]);
    assert_eq!(column(&table("motor_current_a", &["12,5", "-0,25", "3"]), "motor_current_a"), [12.5, -0.25, 3.0]);
}

fn rows(times: impl IntoIterator<Item = f64>) -> String {
    let rows = times.into_iter().enumerate().map(|(row, time)| format!("{time},{},0.1\n", 0.01 * row as f64));
    format!("time_s,motor_position_rad,motor_current_a\n{}", rows.collect::<String>())
}

#[test]
fn a_clock_that_ticks_more_slowly_than_rows_come_is_reported_and_spread() {
    let ticking = rows((0..300).map(|row| f64::from(row * 5 / 16) * 0.016));
    refused(
        &ticking,
        &[
            "run.csv, line 3: column time_s: expected a time after 0 s, found 0 s",
            "206 of 300 rows repeat a time stamp: its clock ticks every 16 ms, rows come every 5 ms",
            "Use --time-from-rate 200 or --spread-time",
        ],
    );
    let spread = take(&ticking, &Choices { spread_time: true, ..Choices::default() }).unwrap().0;
    let time_s = spread.column("time_s").unwrap();
    assert!(time_s.iter().enumerate().all(|(row, time)| (time - 0.005 * row as f64).abs() < 0.005), "{time_s:?}");
    let (counted, notes) = take(&ticking, &Choices { time_from_rate: Some(200.0), ..Choices::default() }).unwrap();
    assert!((counted.column("time_s").unwrap()[299] - 1.495).abs() < 1e-12);
    assert!(notes[0].message.contains("“time_s” counts the rows, 200 a second"), "{notes:?}");
}

#[test]
fn a_time_without_a_unit_states_its_step_without_trailing_zeros() {
    for (step, words) in [(1.0, "its rows are 1 apart"), (2.5, "its rows are 2.5 apart")] {
        let counter = rows((0..40).map(|row| step * f64::from(row))).replace("time_s", "time");
        refused(&counter, &[words, "--unit time_s=ms"]);
    }
}

#[test]
fn several_recordings_in_a_file_are_reported_and_split() {
    let twice = rows((0..40).map(|row| 0.01 * f64::from(row % 20)));
    refused(&twice, &["line 22, column time_s: the time begins again: the file holds 2 recordings. Use --split-runs"]);
    let (run, notes) = take(&twice, &Choices { split_runs: true, ..Choices::default() }).unwrap();
    assert_eq!(run.column("run").unwrap().iter().sum::<f64>(), 20.0);
    assert!(notes.iter().any(|note| note.message.contains("2 recordings, numbered in column “run”")), "{notes:?}");
    let slip = rows((0..40).map(|row| if row == 30 { 0.285 } else { 0.01 * f64::from(row) }));
    refused(&slip, &["line 32", "in 1 of 40 rows the time goes back", "Use --time-from-rate 100"]);
}

#[test]
fn a_table_without_a_time_gets_one() {
    let bare = "motor_position_rad,motor_current_a\n0.1,1\n0.2,2\n0.3,3\n";
    refused(bare, &["column time_s is missing", "a table without a time has one by its rate: --rate HZ"]);
    let (run, _) = take(bare, &Choices { rate: Some(50.0), ..Choices::default() }).unwrap();
    assert_eq!(run.column("time_s").unwrap(), [0.0, 0.02, 0.04]);
    let message = take(&rows([0.0, 1.0]), &Choices { rate: Some(50.0), ..Choices::default() }).unwrap_err().to_string();
    assert!(message.contains("the table has a time of its own. Use --time-from-rate 50"), "{message}");
}

#[test]
fn foreign_names_are_proposed_and_not_taken() {
    let foreign = "Time [ms],pos_deg,Iq [A]\n0,0,0.1\n5,1,0.2\n10,2,0.1\n";
    refused(
        foreign,
        &[
            "column motor_position_rad is missing",
            "the file seems to hold it: --map motor_position_rad=pos_deg --unit motor_position_rad=deg --map 'motor_current_a=Iq [A]'",
        ],
    );
    let choices = Choices {
        map: vec!["motor_position_rad=pos_deg".into(), "motor_current_a=Iq [A]".into()],
        unit: vec!["motor_position_rad=deg".into()],
        ..Choices::default()
    };
    let (run, _) = take(foreign, &choices).unwrap();
    assert_eq!(run.column("time_s").unwrap(), [0.0, 0.005, 0.01]);
    assert!((run.column("motor_position_rad").unwrap()[2] - 2.0_f64.to_radians()).abs() < 1e-12);
}

#[test]
fn a_line_of_units_that_contradicts_a_name_is_asked_about() {
    let text = "time_s,motor_position_rad,motor_current_a\ns,deg,A\n0,90,0.1\n1,91,0.1\n";
    refused(
        text,
        &[
            "the file says deg for column “motor_position_rad”",
            "--unit motor_position_rad=deg or --unit motor_position_rad=rad",
        ],
    );
    let choices = Choices { unit: vec!["motor_position_rad=deg".into()], ..Choices::default() };
    let (run, _) = take(text, &choices).unwrap();
    assert!((run.column("motor_position_rad").unwrap()[0] - 90.0_f64.to_radians()).abs() < 1e-12);
}

#[test]
fn names_that_are_empty_or_there_twice_are_given() {
    let text = "time_s,,motor_current_a,motor_current_a\n0,7,0.1,5\n1,8,0.1,5\n";
    refused(
        text,
        &["column motor_position_rad is missing", "the file has time_s, column_2, motor_current_a, motor_current_a_2"],
    );
    let (run, notes) =
        take(text, &Choices { map: vec!["motor_position_rad=column_2".into()], ..Choices::default() }).unwrap();
    assert_eq!(
        (run.column("motor_position_rad").unwrap(), run.column("motor_current_a").unwrap()),
        (&[7.0, 8.0][..], &[0.1, 0.1][..])
    );
    assert!(notes.iter().any(|note| note.message.contains("two columns are called “motor_current_a”")), "{notes:?}");
}

#[test]
fn a_table_without_names_is_mapped_by_the_places_of_its_columns() {
    let bare = "0,1.5,2\n0.004,1.6,2\n0.008,1.7,2\n";
    refused(
        bare,
        &["a friction run needs time_s, motor_position_rad, motor_current_a. Use --names time,column_2,column_3"],
    );
    let map = ["time_s=column_1", "motor_position_rad=column_2", "motor_current_a=column_3"];
    let choices = Choices { map: map.map(str::to_owned).to_vec(), unit: vec!["time_s=s".into()], ..Choices::default() };
    let (run, notes) = take(bare, &choices).unwrap();
    assert_eq!(run.column("motor_position_rad").unwrap(), [1.5, 1.6, 1.7]);
    assert_eq!(notes[0].option.as_ref().map(|option| option.text.as_str()), Some("--names time,column_2,column_3"));
}

#[test]
fn codes_for_an_empty_cell_are_asked_about() {
    let cells: Vec<String> = (0..40).map(|row| if row % 9 == 4 { "OVLD".into() } else { format!("0,{row}") }).collect();
    let words = table("motor_current_a", &cells.iter().map(String::as_str).collect::<Vec<_>>());
    refused(&words, &["expected a number, found “OVLD”", "Use --missing OVLD --leave-empty-rows"]);
    let choices =
        |missing: &str| Choices { missing: vec![missing.into()], leave_empty_rows: true, ..Choices::default() };
    assert_eq!(take(&words, &choices("ovld")).unwrap().0.len(), 36);

    for (code, option) in [("-9999", "-9999"), ("9,9E+37", "9.9e37")] {
        let numbers = words.replace("OVLD", code);
        refused(
            &numbers,
            &[
                "line 6, column motor_current_a",
                "4 of 40 cells are",
                "far from all others: perhaps a code for an empty cell",
                &format!("Use --missing {option} --leave-empty-rows or --missing none"),
            ],
        );
        assert_eq!(take(&numbers, &choices(option)).unwrap().0.len(), 36);
        assert!(take(&numbers, &choices("OVLD")).is_err(), "another code is still asked about");
        assert_eq!(take(&numbers, &choices("none")).unwrap().0.len(), 40, "they are what was measured");
    }
}

#[test]
fn lines_below_the_last_row_are_skipped_and_reported() {
    let whole = rows((0..30).map(|row| 0.01 * f64::from(row)));
    let footed = format!("{whole}Mean,,0.1\nEnd of file\n");
    let (run, notes) = take(&footed, &Choices::default()).unwrap();
    assert_eq!(run.len(), 30);
    assert_eq!(notes[0].message, "2 lines below the last row skipped, from line 32");
    refused(&format!("{whole}0.3,0.3\n"), &["line 32: expected 3 values as in the line of column names, found 2"]);
    refused(&whole.replacen("0.05,", "broken,", 1), &["line 7, column time_s: expected a number, found “broken”"]);
}

#[test]
fn a_comment_in_the_last_column_is_no_row_of_another_width() {
    let mut text = String::from("time_s\tmotor_position_rad\tmotor_current_a\tComment\n0\t0.5\t0.1\tstart of test\n");
    text.extend((1..30).map(|row| format!("0.{row:02}\t0.5\t0.1\n")));
    let (run, notes) = take(&text, &Choices::default()).unwrap();
    assert_eq!((run.len(), run.column("Comment")), (30, None));
    assert!(notes.iter().any(|note| note.message.contains("column “Comment” is omitted: it holds words")), "{notes:?}");
}

#[test]
fn a_counter_that_overflows_goes_on() {
    let micros = |row: u64| (4_294_900_000 + 5000 * row) % 4_294_967_296;
    let rows: String = (0..40).map(|row| format!("{},0.5,0.1\n", micros(row))).collect();
    let text = format!("time_us,motor_position_rad,motor_current_a\n{rows}");
    let choices = |unwrap: &[&str]| Choices {
        map: vec!["time_s=time_us".into()],
        unwrap: unwrap.iter().map(|text| (*text).to_owned()).collect(),
        ..Choices::default()
    };
    let message = take(&text, &choices(&[])).unwrap_err().to_string();
    assert!(
        message.ends_with(
            "the time restarts, as a 32-bit counter does when it overflows. Use --unwrap time_s=4294.967296"
        ),
        "{message}"
    );
    let (run, _) = take(&text, &choices(&["time_s=4294.967296"])).unwrap();
    let time_s = run.column("time_s").unwrap();
    assert!((time_s[39] - time_s[0] - 0.195).abs() < 1e-9, "{time_s:?}");
}

#[test]
fn what_another_table_in_the_file_holds_is_never_taken_in() {
    let first = rows((0..30).map(|row| 0.01 * f64::from(row)));
    let second = "time_s,motor_position_rad,motor_current_a\ns,deg,mA\n0.5,90,100\n";
    refused(&format!("{first}{second}"), &["line 33", "as the names or units of another table"]);
    let own_clocks = "Time [s],motor_position_rad,Time [s],motor_current_a\n";
    let clocks = |late: f64| -> String {
        let row = |row: i32| format!("{},{row},{},0.{row}\n", 0.01 * f64::from(row), 0.01 * f64::from(row) + late);
        own_clocks.to_owned() + &(0..30).map(row).collect::<String>()
    };
    refused(&clocks(0.25), &["two columns of time differ by up to 0.2500 s", "Use --leave 'Time [s]_2'"]);
    assert_eq!(take(&clocks(0.0), &Choices::default()).unwrap().0.len(), 30);
}

#[test]
fn units_at_the_end_of_a_name_keep_their_case() {
    let text = "time_s,motor_position_rad,motor_current_mA\n0,1,100\n0.01,2,200\n";
    refused(text, &["--map motor_current_a=motor_current_mA --unit motor_current_a=mA"]);
    let choices = Choices { map: vec!["motor_current_a=motor_current_mA".into()], ..Choices::default() };
    assert_eq!(take(text, &choices).unwrap().0.column("motor_current_a").unwrap(), [0.1, 0.2]);
}

#[test]
fn fortran_and_typesetters_write_numbers_too() {
    let text = table("motor_current_a", &["1,5D-01", "\u{2212}0,25", "1,0d+00"]);
    assert_eq!(column(&text, "motor_current_a"), [0.15, -0.25, 1.0]);
}

/// Without a kind each column may be needed: one empty cell is a question, many are a reason to omit the column.
#[test]
fn a_conversion_keeps_a_column_with_few_gaps() {
    let convert = |text: &str| understand_bytes("run.csv", text.as_bytes(), &ReadOptions::default());
    let text = "time_s,force,remark\n0.1,1,\n0.2,2,\n0.3,,4\n0.4,4,\n0.5,5,\n";
    let message = convert(text).unwrap_err().to_string();
    assert!(message.contains("line 4, column force") && message.contains("--leave-empty-rows"), "{message}");
    let sparse = text.replace(",,4", ",3,4");
    let table = convert(&sparse).unwrap();
    assert_eq!(table.trace.column("force").unwrap(), [1.0, 2.0, 3.0, 4.0, 5.0]);
    assert!(table.trace.column("remark").is_none() && table.left == ["remark"], "{:?}", table.left);
}

#[test]
fn rows_are_omitted_by_their_lines() {
    let good = |row: usize| format!("{},{},0.1\n", 0.01 * row as f64, 0.02 * row as f64);
    let mut lines: Vec<String> = (0..40).map(good).collect();
    lines[4] = "0.04,0.08,12.3.4\n".into();
    lines[9] = "0.09,0.18\n".into();
    lines[20] = "marker,pressed,by hand\n".into();
    let text = format!("# bench 3\ntime_s,motor_position_rad,motor_current_a\n{}", lines.concat());
    let omit = |rows: &str| take(&text, &Choices { omit_rows: vec![rows.into()], ..Choices::default() });

    // The lines of a text, as an editor counts them: the first sample is line 3.
    refused(&text, &["run.csv, line 23: a row of words stands between the rows"]);
    let message = omit("23").unwrap_err().to_string();
    assert!(message.contains("run.csv, line 7, column motor_current_a"), "{message}");
    assert!(message.contains("and 1 more row is wrong: line 12:"), "{message}");
    assert!(message.ends_with("Use --omit-rows 7,12"), "{message}");

    let (run, notes) = omit("7, 12, 23").unwrap();
    assert_eq!((run.len(), &run.meta().other[jointbench_files::LEFT_OUT_ROWS]), (37, &3.into()));
    assert!(notes.iter().any(|note| note.message == "3 rows omitted as asked"), "{notes:?}");
    let times = run.column("time_s").unwrap();
    assert_eq!((times[3], times[4], times[36]), (0.03, 0.05, 0.39));

    // A start and an end; a fault after omitted rows is still at its own line.
    let (run, _) = omit("1-24, 30-").unwrap();
    assert_eq!(run.len(), 5);
    let late = text.replace("0.3,0.6,0.1", "0.3,0.6,1..2");
    let message =
        take(&late, &Choices { omit_rows: vec!["3-23".into()], ..Choices::default() }).unwrap_err().to_string();
    assert!(message.contains("run.csv, line 33, column motor_current_a"), "{message}");

    for (rows, word) in
        [("43-50", "row 43 cannot be omitted: the rows of the file are 3 to 42"), ("1-", "all rows are omitted")]
    {
        let message = omit(rows).unwrap_err().to_string();
        assert!(message.contains(word), "{message}");
    }
}

#[test]
fn omitted_and_empty_rows_are_counted_together() {
    let mut lines: Vec<String> =
        (0..30).map(|row| format!("{},{},0.1\n", 0.01 * row as f64, 0.02 * row as f64)).collect();
    lines[3] = "0.03,0.06,\n".into();
    lines[8] = "0.08,0.16,\n".into();
    let text = format!("time_s,motor_position_rad,motor_current_a\n{}", lines.concat());
    let choices = Choices { omit_rows: vec!["2-4".into(), "5".into()], leave_empty_rows: true, ..Choices::default() };
    let (run, _) = take(&text, &choices).unwrap();
    assert_eq!((run.len(), &run.meta().other[jointbench_files::LEFT_OUT_ROWS]), (25, &5.into()));
    assert_eq!(run.column("time_s").unwrap()[3..5], [0.07, 0.09]);
}
