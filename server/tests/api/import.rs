//! Import and export of files over HTTP.

use crate::daemon::TestDaemon;
use serde_json::Value;

const GOOD: &str = "time_s,motor_position_rad,motor_current_a\n0,0,0.1\n0.004,0.01,0.2\n0.008,0.02,0.1\n";
const META: &str = r#"{"kind": "friction", "torque_constant_nm_per_a": 0.04}"#;

pub fn upload(daemon: &TestDaemon, table: &str, more: &[(&str, &str)]) -> (u16, Value) {
    send(daemon, "/api/v1/runs/import", table, more)
}

fn send(daemon: &TestDaemon, address: &str, table: &str, more: &[(&str, &str)]) -> (u16, Value) {
    let mut body = String::new();
    let mut part = |name: &str, content: &str| {
        body += &format!("--edge\r\nContent-Disposition: form-data; name={name}\r\n\r\n{content}\r\n");
    };
    part("\"file\"; filename=\"bench.csv\"", table);
    more.iter().for_each(|(name, content)| part(&format!("\"{name}\""), content));
    body += "--edge--\r\n";
    let media_type = ("content-type", "multipart/form-data; boundary=edge");
    daemon.post_with(address, body.as_bytes(), &[media_type])
}

#[test]
fn a_refused_file_is_located_and_leaves_nothing() {
    let daemon = TestDaemon::start();
    for (table, line, column) in [
        (GOOD.replace("0.02,", "x,"), Some(4), Some("motor_position_rad")),
        (GOOD.replace("0.004", "-1"), Some(3), Some("time_s")),
        (GOOD.replace("0.01,0.2", "0.01"), Some(3), None),
        (GOOD.replace("motor_current_a", "amps"), Some(1), Some("motor_current_a")),
        (GOOD.replace("motor_position_rad", "motor_position_deg"), Some(1), Some("motor_position_deg")),
        (String::new(), None, None),
    ] {
        let (status, problem) = upload(&daemon, &table, &[("meta", META)]);
        assert_eq!(status, 422, "{problem}");
        assert_eq!(problem["type"], "urn:jointbench:file_refused");
        assert!(problem["detail"].as_str().unwrap().starts_with("bench.csv"), "{problem}");
        if line.is_some() {
            assert_eq!(problem["line"].as_u64(), line, "{problem}");
        }
        if column.is_some() {
            assert_eq!(problem["column"].as_str(), column, "{problem}");
        }
    }
    let (status, problem) = upload(&daemon, GOOD, &[("meta", META), ("scale", "motor_position_rad=deg")]);
    assert_eq!(status, 422, "{problem}");
    let (status, problem) = upload(&daemon, GOOD, &[]);
    assert_eq!(status, 422, "the kind is not known: {problem}");
    assert_eq!(daemon.get("/api/v1/runs").1["total"], 0);
}

#[test]
fn rows_with_empty_cells_stay_out_where_that_is_asked_for() {
    let daemon = TestDaemon::start();
    let gap = GOOD.replace("0.01,0.2", "0.01,");
    let (status, problem) = upload(&daemon, &gap, &[("meta", META)]);
    assert!(status == 422 && problem["detail"].as_str().unwrap().contains("--leave-empty-rows"), "{problem}");
    let (status, run) = upload(&daemon, &gap, &[("meta", META), ("leave_empty_rows", "true")]);
    assert_eq!((status, &run["rows"]), (201, &2.into()), "{run}");
    assert!(run["provenance"]["imported"]["understood"].to_string().contains("for an empty cell: 1"), "{run}");
}

#[test]
fn rows_that_are_no_samples_are_listed_and_omitted_by_their_lines() {
    let daemon = TestDaemon::start();
    let samples: String =
        (0..20).map(|row| format!("{},{},0.2\n", 0.01 * f64::from(row), 0.1 * f64::from(row))).collect();
    let log = format!("time_s,motor_position_rad,motor_current_a\n{samples}")
        .replace("0.05,0.5,0.2", "0.05,0.5,0.2.1")
        .replace("0.09,0.9,0.2", "0.09,0.9");
    let (status, preview) = send(&daemon, "/api/v1/runs/import/preview", &log, &[("meta", META)]);
    let refused = &preview["refused"];
    assert_eq!((status, &refused["row_count"]), (200, &2.into()), "{preview}");
    assert_eq!((&refused["rows"][0]["line"], &refused["rows"][1]["line"]), (&7.into(), &11.into()), "{preview}");
    assert_eq!(
        refused["proposed"][0]["parts"],
        serde_json::json!([{"name": "omit_rows", "value": "7,11"}]),
        "{preview}"
    );
    let (status, run) = upload(&daemon, &log, &[("meta", META), ("omit_rows", "7,11"), ("omit_rows", "20-")]);
    assert_eq!((status, &run["rows"]), (201, &16.into()), "{run}");
    let (status, problem) = upload(&daemon, &log, &[("meta", META), ("omit_rows", "40")]);
    assert!(status == 422 && problem["detail"].as_str().unwrap().contains("row 40 cannot be omitted"), "{problem}");
}

#[test]
fn what_goes_out_comes_in_again_unchanged() {
    let daemon = TestDaemon::start();
    let (status, run) = upload(&daemon, GOOD, &[("meta", META), ("scale", "motor_current_a=2")]);
    assert_eq!(status, 201, "{run}");
    assert_eq!((&run["state"], &run["rows"], &run["procedure"]), (&"completed".into(), &3.into(), &"import".into()));
    let out = |id: &Value| {
        daemon.get_raw(&format!("/api/v1/runs/{id}/export?format=csv")).into_body().read_to_string().unwrap()
    };
    let exported = out(&run["id"]);
    assert!(exported.contains("0.4"), "{exported}");
    let (status, again) = upload(&daemon, &exported, &[("meta", META)]);
    assert_eq!((status, &again["provenance"]["imported"]["copy_of"]), (201, &run["id"]), "{again}");
    assert_eq!(out(&again["id"]), exported);
    let (_, samples) = daemon.get(&format!("/api/v1/runs/{}/samples?channels=motor_current_a", again["id"]));
    assert_eq!(samples["channels"][0]["min"], serde_json::json!([0.2, 0.4, 0.2]));
    assert_eq!((&samples["exact"], &samples["channels"][0]["unit"]), (&true.into(), &"A".into()));
}

#[test]
fn a_stretch_goes_out_and_is_summed_up_in_full_resolution() {
    let daemon = TestDaemon::start();
    let (status, run) = upload(&daemon, GOOD, &[("meta", META)]);
    assert_eq!(status, 201, "{run}");
    let path = format!("/api/v1/runs/{}", run["id"]);
    let mut part = daemon.get_raw(&format!("{path}/export?format=csv&from_s=0.001&to_s=0.004")).into_body();
    assert_eq!(part.read_to_string().unwrap().lines().count(), 2, "a head and the one row in the stretch");
    let (status, figures) = daemon.get(&format!("{path}/statistics?channels=motor_current_a&from_s=0.004"));
    assert_eq!((status, figures.as_array().unwrap().len()), (200, 1), "{figures}");
    let current = &figures[0];
    let is = |name: &str, wanted: f64| assert!((current[name].as_f64().unwrap() - wanted).abs() < 1e-12, "{current}");
    assert_eq!((&current["n"], &current["unit"]), (&2.into(), &"A".into()));
    is("mean", 0.15);
    is("rms", 0.025_f64.sqrt());
    is("deviation", 0.005_f64.sqrt());
    is("min", 0.1);
    is("max", 0.2);
    let (_, none) = daemon.get(&format!("{path}/statistics?from_s=5"));
    assert!(none[0]["n"] == 0 && none[0]["mean"].is_null(), "{none}");
    assert_eq!(
        daemon.get(&format!("{path}/statistics?channels=absent")).0,
        daemon.get(&format!("{path}/samples?channels=absent")).0
    );
}

#[test]
fn a_report_names_the_source_of_its_data() {
    let daemon = TestDaemon::start();
    let report_of = |meta: &str| {
        let (status, run) = upload(&daemon, GOOD, &[("meta", meta)]);
        assert_eq!(status, 201, "{run}");
        let path = format!("/api/v1/runs/{}/report", run["id"]);
        daemon.get_raw(&path).into_body().read_to_string().unwrap()
    };
    let report = report_of(&META.replace('}', r#", "source": "line 3"}"#));
    for part in ["IMPORTED</span>", "bench.csv", "source: line 3", "measured elsewhere"] {
        assert!(report.contains(part), "{part}: {report}");
    }
    assert!(!report.contains("HARDWARE"));
    let report = report_of(&META.replace('}', r#", "simulated": true}"#));
    assert!(report.contains("SIMULATED</span>") && report.contains("bench.csv"), "{report}");
}

#[test]
fn a_preview_shows_the_interpretation_and_stores_nothing() {
    let daemon = TestDaemon::start();
    let foreign = "Time [ms];pos_deg;Iq [A];remark\n0;90;0,1;cold\n4;91;0,2;\n8;92;0,1;\n";
    let (status, seen) = send(&daemon, "/api/v1/runs/import/preview", foreign, &[]);
    assert_eq!((status, &seen["kind"], &seen["rows"]), (200, &"friction".into(), &3.into()), "{seen}");
    let proposed = |column: &str| {
        let all = seen["proposals"].as_array().unwrap();
        let one = all.iter().find(|one| one["column"] == column).unwrap();
        (one["from"].as_str().unwrap().to_owned(), one["unit"].as_str().unwrap_or_default().to_owned())
    };
    assert_eq!(proposed("time_s"), ("Time [ms]".into(), "ms".into()));
    assert_eq!(proposed("motor_position_rad"), ("pos_deg".into(), "deg".into()));
    assert_eq!(proposed("motor_current_a"), ("Iq [A]".into(), "A".into()));
    assert_eq!(seen["left"], serde_json::json!(["remark"]));
    let options = seen["refused"]["options"].to_string();
    assert!(options.contains("--map motor_position_rad=pos_deg --unit motor_position_rad=deg"), "{seen}");

    let choices = [
        ("meta", META),
        ("map", "motor_position_rad=pos_deg"),
        ("unit", "motor_position_rad=deg"),
        ("map", "motor_current_a=Iq [A]"),
    ];
    let (status, seen) = send(&daemon, "/api/v1/runs/import/preview", foreign, &choices);
    assert!(status == 200 && seen["refused"].is_null(), "{seen}");
    assert_eq!(daemon.get("/api/v1/runs").1["total"], 0);
    let (status, run) = upload(&daemon, foreign, &choices);
    assert_eq!((status, &run["rows"]), (201, &3.into()), "{run}");
    let understood = run["provenance"]["imported"]["understood"].as_str().unwrap();
    assert!(understood.contains("column “remark” is omitted: it holds words"), "{understood}");
    let (status, problem) = upload(&daemon, foreign, &[("unit", "motor_position_rad=furlong")]);
    assert!(status == 422 && problem["detail"].as_str().unwrap().contains("expected COLUMN=UNIT"), "{problem}");
}
