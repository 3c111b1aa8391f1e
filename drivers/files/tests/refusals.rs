//! A malformed file is refused with file, line, column and expected content.

use arrow_array::{ArrayRef, Float32Array, Float64Array, Int64Array, RecordBatch, StringArray};
use jointbench_files::{Choices, FileError, ReadOptions, parse_meta, read, read_bytes};
use jointbench_instrument::{Kind, Meta, RunTable};
use std::io::Write;
use std::sync::Arc;

const NAMES: &str = "time_s,motor_position_rad,motor_current_a";

fn take(name: &str, bytes: &[u8]) -> Result<RunTable, FileError> {
    let meta = Some(Meta { kind: Some(Kind::Friction), ..Meta::default() });
    read_bytes(name, bytes, &ReadOptions { meta, ..ReadOptions::default() })
}

#[track_caller]
fn check_refused(text: &[u8], expected: &str) {
    let refused = take("run.csv", text).unwrap_err();
    assert_eq!(refused.to_string(), expected);
}

#[test]
fn text_is_refused_where_it_is_wrong() {
    let with = |rows: &str| format!("{NAMES}\n{rows}").into_bytes();
    check_refused(b"", "run.csv: the file is empty: expected a line of column names, then one line for each sample");
    check_refused(
        &with(""),
        "run.csv, line 1: there are column names and no sample below them: was the table cut off, or is it still being written?",
    );
    check_refused(
        &with("0,1,2\n\n1,1,fast\n"),
        "run.csv, line 4, column motor_current_a: expected a number, found “fast”. Use --missing fast \
         --leave-empty-rows",
    );
    check_refused(
        &with("0,1,\n"),
        "run.csv, line 2, column motor_current_a: expected a number, found nothing. Use --leave-empty-rows",
    );
    check_refused(
        &with("0,1,2\r\n1,1\r\n"),
        "run.csv, line 3: expected 3 values as in the line of column names, found 2",
    );
    check_refused(
        &with("0,1,2\n\r\n1,NaN,2\n"),
        "run.csv, line 4, column motor_position_rad: expected a number, found “NaN”. Use --leave-empty-rows",
    );
    check_refused(
        &with("0,1,2\n1,1,2\n0.5,1,2\n"),
        "run.csv, line 4: column time_s: expected a time after 1 s, found 0.5 s; in 1 of 3 rows the time goes back. Use \
         --time-from-rate 1",
    );
    check_refused(
        b"time_s,motor_position_rad\n0,1\n",
        "run.csv, line 1: column motor_current_a is missing: a table of kind friction needs time_s, motor_position_rad, motor_current_a, \
         and the file has time_s, motor_position_rad; take it from another column with --map motor_current_a=NAME",
    );
    check_refused(
        b"time_s,motor_position_deg,motor_current_a\n0,1,2\n",
        "run.csv, line 1: column motor_position_deg: the unit is not the expected one, expected motor_position_rad; \
         convert it with --map motor_position_rad=motor_position_deg --unit motor_position_rad=deg",
    );
    check_refused(
        &with("0,5,1,5,2,5\n"),
        "run.csv, line 2: expected 3 values as in the line of column names, found 6: where numbers have commas, semicolons or tabs \
         stand between the columns",
    );
    check_refused(
        b"0,1.5,2\n0.004,1.6,2\n",
        "run.csv, line 1: numbers stand where the line of column names is expected; a friction run needs time_s, \
         motor_position_rad, motor_current_a. Use --names time,column_2,column_3",
    );
    check_refused(
        b"PK\x03\x04\0\0\x08",
        "run.csv: this file is binary (byte 0x03), and a table is expected: save the table as CSV or Parquet",
    );
}

#[test]
fn wrong_rows_are_counted_and_the_first_of_them_shown() {
    let rows: Vec<String> = (0..9).map(|i| format!("{i},x,2")).collect();
    let refused = take("run.csv", format!("{NAMES}\n0,1\n{}\n9,1,2\n", rows.join("\n")).as_bytes()).unwrap_err();
    assert_eq!((refused.place.line, refused.place.column.as_deref()), (Some(2), None));
    let expected = |line| format!("; line {line}, column motor_position_rad: expected a number, found “x”");
    let more: Vec<String> = (3..7).map(expected).collect();
    assert_eq!(
        refused.to_string(),
        format!(
            "run.csv, line 2: expected 3 values as in the line of column names, found 2; and 9 more rows are wrong: {}; …",
            more.concat().trim_start_matches("; ")
        )
    );
}

#[test]
fn semicolons_and_tabs_stand_between_columns_and_let_numbers_have_commas() {
    for (separator, position) in
        [(";", "1,5"), ("\t", "1,5"), (";", "1.5"), (",", "1.5"), (",", " 1.5 "), (";", " 1,5 ")]
    {
        let text = format!("{NAMES}\n0,{position},2\n1,{position},2\n", position = "P").replace(',', separator);
        let run = take("run.csv", text.replace('P', position).as_bytes()).unwrap();
        assert_eq!(run.column("motor_position_rad"), Some(&[1.5, 1.5][..]), "{separator:?} {position}");
    }
}

#[test]
fn a_fact_with_a_slip_in_its_name_is_refused_where_it_stands() {
    let refused = parse_meta("meta.json", b"{\n  \"kind\": \"friction\",\n  \"gear_ratoi\": 50\n}").unwrap_err();
    assert_eq!(
        refused.to_string(),
        "meta.json, line 3: gear_ratoi is not known: did you mean gear_ratio? A fact of your own needs a name that is less like it"
    );
    assert_eq!(parse_meta("meta.json", b"{\"kind\": \"friction\", \"oil\": \"VG 32\"}").unwrap().other["oil"], "VG 32");
}

#[test]
fn editors_marks_and_line_ends_are_let_pass() {
    let text = format!("\u{feff}{NAMES}\r\n0, 1 ,2e0\r\n1,1,+2\r\n");
    assert_eq!(take("run.csv", text.as_bytes()).unwrap().column("motor_current_a"), Some(&[2.0, 2.0][..]));
}

#[test]
fn a_packed_file_is_whole_or_refused() {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(format!("{NAMES}\n0,1,2\n1,1,x\n").as_bytes()).unwrap();
    let packed = packed.finish().unwrap();
    let inside = take("run.csv.gz", &packed).unwrap_err().to_string();
    assert!(inside.starts_with("run.csv.gz, line 3, column motor_current_a: expected a number"), "{inside}");
    for broken in [&packed[..packed.len() - 9], &packed[1..], b"plain"] {
        let refused = take("run.csv.gz", broken).unwrap_err().to_string();
        assert!(refused.starts_with("run.csv.gz: not a whole gzip file"), "{refused}");
    }
}

fn parquet(columns: Vec<(&str, ArrayRef)>) -> Vec<u8> {
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let mut bytes = Vec::new();
    let mut writer = parquet::arrow::ArrowWriter::try_new(&mut bytes, batch.schema(), None).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
    bytes
}

fn arrow(columns: Vec<(&str, ArrayRef)>) -> Vec<u8> {
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let mut writer = arrow_ipc::writer::FileWriter::try_new(Vec::new(), &batch.schema()).unwrap();
    writer.write(&batch).unwrap();
    writer.into_inner().unwrap()
}

#[test]
fn columnar_files_of_other_tools_are_read_and_checked() {
    let good: Vec<(&str, ArrayRef)> = vec![
        ("time_s", Arc::new(Float64Array::from(vec![0.0, 0.5]))),
        ("motor_position_rad", Arc::new(Float32Array::from(vec![1.5, -2.0]))),
        ("motor_current_a", Arc::new(Int64Array::from(vec![3, -4]))),
    ];
    for (name, bytes) in [("run.parquet", parquet(good.clone())), ("run.arrow", arrow(good.clone()))] {
        let table = take(name, &bytes).unwrap();
        assert_eq!(table.column("motor_position_rad"), Some(&[1.5, -2.0][..]), "{name}");
        assert_eq!(table.column("motor_current_a"), Some(&[3.0, -4.0][..]), "{name}");
        let cut = take(name, &bytes[..bytes.len() / 2]).unwrap_err().to_string();
        assert!(cut.starts_with(&format!("{name}: not readable")), "{cut}");
    }
    for (column, expected) in [
        (
            Arc::new(Int64Array::from(vec![Some(1), None])) as ArrayRef,
            ", row 2, column motor_current_a: expected a number",
        ),
        (
            Arc::new(Int64Array::from(vec![1, (1 << 53) + 1])),
            ", row 2, column motor_current_a: expected a whole number",
        ),
        (Arc::new(StringArray::from(vec!["1", "2"])), ", column motor_current_a: expected numbers, found Utf8"),
        (Arc::new(Float64Array::from(vec![1.0, f64::INFINITY])), ", row 2: column motor_current_a: expected a finite"),
    ] {
        let columns = vec![good[0].clone(), good[1].clone(), ("motor_current_a", column)];
        for (name, bytes) in [("run.parquet", parquet(columns.clone())), ("run.arrow", arrow(columns.clone()))] {
            let refused = take(name, &bytes).unwrap_err().to_string();
            assert!(refused.starts_with(&format!("{name}{expected}")), "{refused}");
        }
    }
}

#[test]
fn other_files_and_facts_are_refused() {
    let refused = take("run.xlsx", b"").unwrap_err();
    assert_eq!(
        refused.to_string(),
        "run.xlsx: expected a table that ends in .csv, .tsv, .txt, .dat, .asc, .log or .lvm (also with .gz behind it), .parquet or .arrow; save a workbook (.xlsx, .ods) as CSV"
    );
    assert!(!refused.is_io());

    let missing = read("/no/such/run.csv".as_ref(), &ReadOptions::default()).unwrap_err().to_string();
    assert!(missing.starts_with("/no/such/run.csv: "), "{missing}");

    let facts = parse_meta("meta.json", b"{\"kind\": \"friction\",\n \"gear_ratio\": \"fifty\"}").unwrap_err();
    assert_eq!(facts.place.line, Some(2));
    let message = "meta.json, line 2: gear_ratio is \"fifty\": expected a number without quotes, such as 50";
    assert_eq!(facts.to_string(), message);
    let facts = |text: &str| parse_meta("meta.json", text.as_bytes()).unwrap_err().to_string();
    assert!(facts("{\"poles\": 1.5}").contains("poles is 1.5: expected a whole number without quotes"));
    assert!(facts("{\"baseline\": \"coulomb\"}").contains("baseline is \"coulomb\": expected a list, such as"));
    assert!(facts("{\"kind\": \"frction\"}").contains("did you mean friction?"));

    let unknown = read_bytes("run.csv", format!("{NAMES}\n0,1,2\n").as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(unknown.to_string().contains("expected \"kind\": friction, encoder, stiffness or brake"), "{unknown}");
}

#[test]
fn a_last_number_that_is_cut_is_left_out() {
    let rows: Vec<String> = (0..30).map(|i| format!("{:.3},{:.4},{:.4}", 1e-3 * f64::from(i), 1.0, 0.25)).collect();
    let whole = format!("{NAMES}\n{}", rows.join("\n"));
    assert_eq!(take("run.csv", whole.as_bytes()).unwrap().len(), 30, "a line end may be missing");
    let cut = &whole[..whole.len() - 2];
    assert_eq!(take("run.csv", cut.as_bytes()).unwrap().len(), 29, "0.25 is no whole number here");
}

#[test]
fn a_table_of_conditions_asks_for_its_option_and_is_read_with_it() {
    let text = "motor_velocity_rad_s,motor_current_a\n10,0.6\n-10,-0.6\n";
    let refused = take("run.csv", text.as_bytes()).unwrap_err().to_string();
    assert!(refused.contains("--operating-points"), "{refused}");
    let options = Choices { operating_points: true, ..Choices::default() }.options().unwrap();
    let meta = Some(Meta { kind: Some(Kind::Friction), sample_rate_hz: Some(1000.0), ..Meta::default() });
    let run = read_bytes("run.csv", text.as_bytes(), &ReadOptions { meta, ..options }).unwrap();
    assert!(run.meta().operating_points && run.column("time_s") == Some(&[0.0, 1.0][..]));
}

#[test]
fn milliseconds_since_1970_are_no_seconds_whatever_their_name() {
    let rows: Vec<String> = (0..30).map(|i| format!("{},{},0.5", 1_700_000_000_000_u64 + 2 * i, i)).collect();
    let run = take("run.csv", format!("{NAMES}\n{}\n", rows.join("\n")).as_bytes()).unwrap();
    let time_s = run.column("time_s").unwrap();
    assert!((time_s[1] - time_s[0] - 2e-3).abs() < 1e-9, "{:?}", &time_s[..3]);
}

#[test]
fn the_record_of_a_motion_is_no_table_of_conditions() {
    let options = Choices { operating_points: true, ..Choices::default() }.options().unwrap();
    let meta = Some(Meta { kind: Some(Kind::Friction), ..Meta::default() });
    let read =
        |text: &str| read_bytes("run.csv", text.as_bytes(), &ReadOptions { meta: meta.clone(), ..options.clone() });
    let refused = read(&format!("{NAMES}\n0,1,0.5\n1,2,0.5\n")).unwrap_err().to_string();
    assert!(refused.contains("no table of conditions"), "{refused}");
    let refused = read("fast,strong\n10,0.5\n20,0.5\n").unwrap_err().to_string();
    assert!(refused.contains("--map motor_velocity_rad_s=NAME"), "{refused}");
    let refused = read("Speed [rpm],Torque [mNm],Current [A]\n10,1,0.5\n20,1,0.5\n").unwrap_err().to_string();
    for option in [
        "--map 'motor_velocity_rad_s=Speed [rpm]' --unit motor_velocity_rad_s=rpm",
        "--map 'motor_current_a=Current [A]'",
        "--map 'link_torque_nm=Torque [mNm]' --unit link_torque_nm=mNm",
    ] {
        assert!(refused.contains(option), "{refused}");
    }
}

#[test]
fn a_mapped_column_is_converted_from_the_unit_that_its_name_states() {
    let text = "time_s,Angle [deg],Iq (mA)\n0,90,500\n1,180,500\n";
    let map = vec!["motor_position_rad=Angle [deg]".into(), "motor_current_a=Iq (mA)".into()];
    let options = Choices { map, ..Choices::default() }.options().unwrap();
    let meta = Some(Meta { kind: Some(Kind::Friction), ..Meta::default() });
    let run = read_bytes("run.csv", text.as_bytes(), &ReadOptions { meta, ..options }).unwrap();
    assert_eq!(run.column("motor_current_a"), Some(&[0.5, 0.5][..]));
    assert!((run.column("motor_position_rad").unwrap()[1] - std::f64::consts::PI).abs() < 1e-12);
}

#[test]
fn a_column_with_a_gap_is_among_those_of_the_file() {
    let refused = take("run.csv", b"time_s,angle_deg,Iq\n0,1,0.5\n1,2,\n2,3,0.5\n").unwrap_err().to_string();
    assert!(refused.contains("angle_deg, Iq"), "{refused}");
    assert!(refused.contains("--map motor_current_a=Iq"), "{refused}");
}

fn mapped(text: &str, map: &[&str], unit: &[&str]) -> Result<jointbench_instrument::RunTable, String> {
    let own = |list: &[&str]| list.iter().map(|one| one.to_string()).collect();
    let options = Choices { map: own(map), unit: own(unit), ..Choices::default() }.options().unwrap();
    let meta = Some(Meta { kind: Some(Kind::Friction), ..Meta::default() });
    read_bytes("run.csv", text.as_bytes(), &ReadOptions { meta, ..options }).map_err(|fault| fault.to_string())
}

#[test]
fn a_mapped_column_is_converted_from_the_unit_at_the_end_of_its_name() {
    let run = mapped(
        "t_ms,pos_deg,cur_ma\n0,90,500\n5,180,500\n",
        &["time_s=t_ms", "motor_position_rad=pos_deg", "motor_current_a=cur_ma"],
        &[],
    )
    .unwrap();
    assert_eq!((run.column("motor_current_a"), run.column("time_s")), (Some(&[0.5, 0.5][..]), Some(&[0.0, 0.005][..])));
    assert!((run.column("motor_position_rad").unwrap()[1] - std::f64::consts::PI).abs() < 1e-12);
}

#[test]
fn counts_are_asked_for_their_number_per_turn() {
    for name in ["Position [counts]", "pos_inc"] {
        let text = format!("time_s,{name},i\n0,0,0.5\n1,1024,0.5\n");
        let map = [&format!("motor_position_rad={name}")[..], "motor_current_a=i"];
        let refused = mapped(&text, &map, &[]).unwrap_err();
        assert!(refused.contains("--unit motor_position_rad=counts/N"), "{refused}");
        let run = mapped(&text, &map, &["motor_position_rad=counts/4096"]).unwrap();
        assert!((run.column("motor_position_rad").unwrap()[1] - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }
}

#[test]
fn a_unit_of_another_quantity_or_of_a_sliding_axis_is_refused() {
    let text = "time_s,theta_m,Iq [V]\n0,0,0.5\n1,1,0.5\n";
    let map = ["motor_position_rad=theta_m", "motor_current_a=Iq [V]"];
    assert!(mapped(text, &map, &[]).unwrap_err().contains("the file says V for column “motor_current_a”"));
    let message = mapped(text, &map, &["motor_current_a=A", "motor_position_rad=m"]).unwrap_err();
    assert!(message.contains("linear axis") && message.contains("\"motion\": \"linear\""), "{message}");
    let run = mapped(text, &map, &["motor_current_a=A"]).unwrap();
    assert_eq!(run.column("motor_position_rad"), Some(&[0.0, 1.0][..]), "the m of theta_m is the motor");
}

#[test]
fn gaps_are_counted_by_column() {
    let text = "time_s,motor_position_rad,motor_current_a,temperature_c\n0,0,1,20\n1,1,1,\n2,2,1,\n3,3,,\n";
    let refused = take("run.csv", text.as_bytes()).unwrap_err().to_string();
    assert!(refused.contains("motor_current_a 1, temperature_c 3; 1 of 4 rows"), "{refused}");
}

#[test]
fn a_table_of_points_is_proposed_as_one_line() {
    let meta = Some(Meta { kind: Some(Kind::Friction), ..Meta::default() });
    let text = "Speed [rpm];Current [A];Torque [Nm]\n10;1;0.5\n20;1;0.5\n";
    let options = ReadOptions { meta, ..ReadOptions::default() };
    let refused = read_bytes("run.csv", text.as_bytes(), &options).unwrap_err().to_string();
    assert!(refused.contains("--operating-points"), "{refused}");
    assert!(refused.contains("--unit motor_velocity_rad_s=rpm"), "{refused}");
}

#[test]
fn a_line_of_units_may_hold_one_that_cannot_be_converted() {
    let run = mapped(
        "time,angle,current\ns,Grad,mA\n0,90,500\n1,91,500\n",
        &["time_s=time", "motor_position_rad=angle", "motor_current_a=current"],
        &["motor_position_rad=deg"],
    )
    .unwrap();
    assert_eq!(run.column("motor_current_a"), Some(&[0.5, 0.5][..]));
}
