//! An exported table imports again with identical bits.

use jointbench_files::{
    LEFT_OUT_ROWS, ReadOptions, meta_json, parse_meta, read, read_bytes, write, write_csv, write_parquet,
};
use jointbench_instrument::{Channel, Kind, Meta, Trace};
use proptest::prelude::*;

fn any_finite() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>().prop_filter("a table holds finite numbers", |value| value.is_finite()),
        (-1_000_000i32..1_000_000).prop_map(|count| f64::from(count) * 1e-4),
        Just(-0.0),
        Just(f64::MIN_POSITIVE / 8.0),
        Just(f64::MAX),
    ]
}

prop_compose! {
    fn any_run()(rows in 1usize..40)(
        start in -1e6..1e6f64,
        columns in prop::collection::vec(prop::collection::vec(any_finite(), rows), 3),
        gear_ratio in any_finite().prop_filter("no gear has a ratio of 0", |ratio| *ratio != 0.0),
        note in ".{0,12}",
        resolution in prop::option::of(1e-9..1.0f64),
    ) -> (Meta, Trace) {
        let time_s = (0..columns[0].len()).map(|row| start + row as f64 * 0.004).collect();
        let mut meta = Meta { kind: Some(Kind::Friction), gear_ratio: Some(gear_ratio), ..Meta::default() };
        meta.other.insert("note".into(), note.into());
        let channels = vec![
            Channel::new("time_s"),
            Channel { name: "motor_position_rad".into(), resolution },
            Channel::new("motor_current_a"),
            Channel::new("odd, \"name\""),
        ];
        (meta, Trace::from_columns(channels, [vec![time_s], columns].concat()))
    }
}

/// Compares bits, because doubles compare -0.0 equal to 0.0.
fn check_same_bits(name: &str, bytes: &[u8], options: &ReadOptions, meta: &Meta, trace: &Trace) {
    let table = read_bytes(name, bytes, options).unwrap();
    assert_eq!(table.meta(), meta, "{name}");
    assert_eq!(table.trace().channels(), trace.channels(), "{name}");
    for (back, sent) in table.trace().columns().iter().zip(trace.columns()) {
        let bits = |column: &[f64]| column.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(back), bits(sent), "{name}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn csv_and_parquet_give_back_what_they_took((meta, trace) in any_run()) {
        let mut csv = Vec::new();
        write_csv(&mut csv, &trace).unwrap();
        let facts = parse_meta("run.meta.json", meta_json(&meta, trace.channels()).as_bytes()).unwrap();
        let options = ReadOptions { meta: Some(facts), ..ReadOptions::default() };
        check_same_bits("run.csv", &csv, &options, &meta, &trace);

        let mut parquet = Vec::new();
        write_parquet(&mut parquet, &meta, &trace).unwrap();
        check_same_bits("run.parquet", &parquet, &ReadOptions::default(), &meta, &trace);
    }
}

#[test]
fn a_file_finds_its_facts_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut trace = Trace::new(
        [("time_s", None), ("motor_position_rad", Some(1e-4)), ("motor_current_a", None)]
            .map(|(name, resolution)| Channel { name: name.into(), resolution })
            .to_vec(),
    );
    trace.push_row(&[0.0, 1e-4, 0.25]);
    trace.push_row(&[0.004, 3e-4, -0.25]);
    let meta = Meta { kind: Some(Kind::Friction), gear_ratio: Some(50.0), ..Meta::default() };
    for name in ["run-1.csv", "run-2.csv.gz", "run-3.parquet"] {
        let path = folder.path().join(name);
        write(&path, &meta, &trace).unwrap();
        let table = read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(table.into_parts(), (meta.clone(), trace.clone()), "{name}");
    }

    let general = Meta { kind: Some(Kind::Stiffness), ..Meta::default() };
    std::fs::write(folder.path().join("meta.json"), meta_json(&general, &[])).unwrap();
    std::fs::rename(folder.path().join("run-1.csv"), folder.path().join("other.csv")).unwrap();
    let refused = read(&folder.path().join("other.csv"), &ReadOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("a table of kind stiffness needs"), "the facts of the folder hold: {refused}");
}

#[test]
fn rows_with_empty_cells_stay_out_where_that_is_asked_for() {
    let csv = "time_s,motor_position_rad,motor_current_a\n0,1,1\n1,,2\n2,3,3\n3,4,x\n";
    let meta = Some(Meta { kind: Some(Kind::Friction), ..Meta::default() });
    let options = ReadOptions { meta, leave_empty_rows: true, ..ReadOptions::default() };
    let table = read_bytes("log.csv", csv.replace('x', "4").as_bytes(), &options).unwrap();
    assert_eq!(table.column("time_s"), Some(&[0.0, 2.0, 3.0][..]));
    assert_eq!(table.meta().other[LEFT_OUT_ROWS], 1);

    let refused = |csv: &str, options| read_bytes("log.csv", csv.as_bytes(), options).unwrap_err().to_string();
    assert!(refused(csv, &options).contains("line 5, column motor_current_a: expected a number, found “x”"));
    // A fault of the whole table also states its line in the file.
    assert!(refused(&csv.replace("3,4,x", "2,4,4"), &options).contains("line 5"));
    let silent = ReadOptions { leave_empty_rows: false, ..options.clone() };
    assert!(refused(csv, &silent).contains("Use --missing x --leave-empty-rows"));
}

#[test]
fn columns_are_renamed_and_scaled_on_the_way_in() {
    let csv = "remark,t,q_deg,Iq\ncold,0,180,1.5\n,1,90,2\n";
    let options = ReadOptions {
        meta: Some(Meta { kind: Some(Kind::Friction), ..Meta::default() }),
        map: [("time_s", "t"), ("motor_position_rad", "q_deg"), ("motor_current_a", "Iq")]
            .map(|(name, column)| (name.into(), column.into()))
            .to_vec(),
        scale: vec![("motor_position_rad".into(), std::f64::consts::PI / 180.0), ("time_s".into(), 1e-3)],
        leave: vec!["remark".into()],
        ..ReadOptions::default()
    };
    let table = read_bytes("log.csv", csv.as_bytes(), &options).unwrap();
    let position_rad = table.column("motor_position_rad").unwrap();
    assert!((position_rad[0] - std::f64::consts::PI).abs() < 1e-15, "{position_rad:?}");
    assert_eq!(table.column("time_s"), Some(&[0.0, 1e-3][..]));
    assert_eq!(table.column("motor_current_a"), Some(&[1.5, 2.0][..]));
    assert_eq!(table.column("remark"), None);

    for (options, named) in [
        (ReadOptions { map: vec![("motor_current_a".into(), "Id".into())], ..options.clone() }, "Id"),
        (ReadOptions { scale: vec![("link_torque_nm".into(), 2.0)], ..options.clone() }, "link_torque_nm"),
        (ReadOptions { leave: vec!["note".into(), "remark".into()], ..options.clone() }, "note"),
    ] {
        let refused = read_bytes("log.csv", csv.as_bytes(), &options).unwrap_err().to_string();
        assert!(refused.contains(named) && refused.contains("it has"), "{refused}");
    }
}
