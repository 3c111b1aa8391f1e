//! Units under test.

use crate::daemon::{SHORT_RUN, TestDaemon};
use crate::import::upload;
use serde_json::{Value, json};

fn run_of(unit: &Value, operator: &str) -> Value {
    let mut new: Value = serde_json::from_str(SHORT_RUN).unwrap();
    new["unit"] = unit.clone();
    new["operator"] = operator.into();
    new
}

fn started(daemon: &TestDaemon, unit: Value, operator: &str) -> i64 {
    let (status, run) = daemon.post("/api/v1/runs", &run_of(&unit, operator).to_string());
    assert_eq!((status, &run["unit"]), (201, &unit), "{run}");
    run["id"].as_i64().unwrap()
}

#[test]
fn runs_of_units_are_kept_found_and_counted() {
    let daemon = TestDaemon::start();
    let unit = |serial: &str, batch: &str| json!({"serial": serial, "part": "P", "revision": "B", "batch": batch});
    let first = started(&daemon, unit("SN123", "7"), "A. Smith");
    daemon.wait_for_end(first);
    let aborted = started(&daemon, unit("sn124", "8"), "Z");
    daemon.post(&format!("/api/v1/runs/{aborted}/abort"), "");
    daemon.wait_for_end(aborted);
    let (_, without) = daemon.post("/api/v1/runs", SHORT_RUN);
    assert!(without.get("unit").is_none() && without.get("operator").is_none(), "{without}");
    daemon.wait_for_end(without["id"].as_i64().unwrap());

    let found = |search: &str| -> Vec<i64> {
        let (status, list) = daemon.get(&format!("/api/v1/runs?search={search}"));
        assert_eq!(status, 200, "{list}");
        list["runs"].as_array().unwrap().iter().map(|run| run["id"].as_i64().unwrap()).collect()
    };
    for (search, ids) in [
        ("unit:sn123", vec![first]),
        ("unit:SN", vec![aborted, first]),
        ("part:p%20-batch:7", vec![aborted]),
        ("operator:%22a.%20smith%22", vec![first]),
        ("SN124", vec![aborted]),
    ] {
        assert_eq!(found(search), ids, "{search}");
    }
    let (_, meta) = daemon.get(&format!("/api/v1/runs/{first}/meta"));
    assert_eq!((&meta["unit"], &meta["operator"]), (&unit("SN123", "7"), &"A. Smith".into()), "{meta}");
    let page = daemon.get_raw(&format!("/api/v1/runs/{first}/report")).body_mut().read_to_string().unwrap();
    assert!(page.contains("SN123, part P, revision B, batch 7") && page.contains("Operator A. Smith"), "{page}");

    let list = daemon.wait_for("/api/v1/units", |list| !list["yields"].as_array().unwrap().is_empty());
    let units = list["units"].as_array().unwrap();
    assert_eq!((&list["total"], &units[0]["serial"]), (&2.into(), &"sn124".into()), "newest first: {list}");
    assert_eq!((&units[0]["first_verdict"], &units[0]["runs"]), (&Value::Null, &1.into()), "it was aborted: {list}");
    assert_eq!((&units[1]["newest_run"], &units[1]["batch"]), (&first.into(), &"7".into()), "{list}");
    assert_eq!(units[1]["first_verdict"], units[1]["newest_verdict"]);
    let yields = list["yields"].as_array().unwrap();
    let groups: Vec<_> = yields.iter().map(|one| (&one["group"], &one["batch"], &one["units"])).collect();
    let (one, none) = (&json!(1), &Value::Null);
    assert_eq!(
        groups,
        [(&"part".into(), none, one), (&"revision".into(), none, one), (&"batch".into(), &"7".into(), one)]
    );
    assert!(yields[0]["ci95"][0].as_f64() < yields[0]["ci95"][1].as_f64(), "{list}");
    assert_eq!(daemon.get("/api/v1/units?search=batch:8").1["total"], 1);
    assert_eq!(daemon.get("/api/v1/units?search=colour:red").0, 422);
    let (_, typing) = daemon.get("/api/v1/units?search=colour:red&typing=true");
    assert!(typing["unclear"].as_str().unwrap().contains("there is no field colour"), "{typing}");
}

#[test]
fn a_reference_unit_has_no_yield() {
    let daemon = TestDaemon::start();
    daemon.wait_for_end(started(&daemon, json!({"serial": "A/1"}), ""));
    let list = daemon.wait_for("/api/v1/units", |list| !list["yields"].as_array().unwrap().is_empty());
    let mark = |serial: &str, reference: bool| {
        let body = json!({"reference": reference}).to_string();
        let path = format!("/api/v1/units/{serial}/reference");
        daemon.put_with(&path, body.as_bytes(), &[("content-type", "application/json")])
    };
    let (status, marked) = mark("A%2F1", true);
    assert_eq!((status, &marked["reference"], &marked["runs"]), (200, &true.into(), &1.into()), "{marked}");
    assert_eq!(daemon.get("/api/v1/units").1["yields"], json!([]));
    assert_eq!(mark("A%2F1", false).1["reference"], false);
    let json = [("content-type", "application/json")];
    let (status, refused) = daemon.put_with("/api/v1/units/A%2F1/reference", b"[true]", &json);
    assert_eq!(status, 400, "a list of the fields is no object: {refused}");
    assert!(refused["detail"].as_str().unwrap().contains("expected a JSON object with named fields"), "{refused}");
    assert_eq!(daemon.get("/api/v1/units").1["yields"], list["yields"]);
    assert_eq!(mark("SN9", true).0, 404);
}

#[test]
fn a_continued_run_has_the_same_unit_and_no_operator() {
    let daemon = TestDaemon::start();
    let unit = json!({"serial": "SN1", "part": "P"});
    let id = started(&daemon, unit.clone(), "A. Smith");
    let is_begun = |run: &Value| run["progress"]["step"].as_u64().is_some_and(|step| step > 20);
    daemon.wait_for(&format!("/api/v1/runs/{id}"), is_begun);
    daemon.post(&format!("/api/v1/runs/{id}/abort"), "");
    daemon.wait_for_end(id);
    let (status, rest) = daemon.post(&format!("/api/v1/runs/{id}/continue"), "");
    assert_eq!((status, &rest["unit"], rest.get("operator")), (201, &unit, None), "{rest}");
    daemon.wait_for_end(rest["id"].as_i64().unwrap());
    let (_, list) = daemon.get("/api/v1/units");
    assert_eq!((&list["total"], &list["units"][0]["runs"]), (&json!(1), &json!(2)), "{list}");
}

#[test]
fn a_unit_is_one_line_with_a_serial_number_and_returns_from_a_file() {
    let daemon = TestDaemon::start();
    for (unit, operator, why) in [
        (json!({"part": "P"}), "", "the serial number is missing: enter it"),
        (json!({"serial": "x".repeat(81)}), "", "serial: write 1 to 80 characters in one line"),
        (json!({"serial": "SN\u{1b}[2J"}), "", "serial: write 1 to 80"),
        (json!({"serial": "SN1", "batch": "a\nb"}), "", "batch: write 1 to 80"),
        (json!({"serial": "SN1"}), "gpj.\u{202e}x", "operator: write 1 to 80"),
    ] {
        let (status, problem) = daemon.post("/api/v1/runs", &run_of(&unit, operator).to_string());
        assert_eq!(status, 422, "{problem}");
        assert!(problem["detail"].as_str().unwrap().contains(why), "{problem}");
    }
    let unknown = daemon.post("/api/v1/runs", &run_of(&json!({"serial": "SN1", "colour": "red"}), "").to_string());
    assert_eq!(unknown.0, 400, "{}", unknown.1);
    assert!(unknown.1["detail"].as_str().unwrap().contains("unknown field `colour`"), "{}", unknown.1);
    assert_eq!(daemon.get("/api/v1/runs").1["total"], 0, "nothing has moved");

    let table = "time_s,motor_position_rad,motor_current_a\n0,0,0.1\n0.004,0.01,0.2\n0.008,0.02,0.1\n";
    let meta = r#"{"kind": "friction", "torque_constant_nm_per_a": 0.04, "unit": {"serial": "SN9"}, "operator": "B"}"#;
    let (status, run) = upload(&daemon, table, &[("meta", meta)]);
    assert_eq!((status, &run["unit"], &run["operator"]), (201, &json!({"serial": "SN9"}), &"B".into()), "{run}");
    assert!(run["meta"].get("unit").is_none(), "in one place: {run}");
    let (_, list) = daemon.get("/api/v1/units");
    assert_eq!((&list["units"][0]["serial"], &list["yields"]), (&"SN9".into(), &json!([])), "{list}");
}

/// The same mock joint under six serial numbers: nothing is beyond chance, and the units hardly differ.
#[test]
fn a_quantity_of_the_units_has_a_control_chart_and_a_capability() {
    let daemon = TestDaemon::start();
    let limits = "[[limit]]\nquantity = \"tau_c\"\nlower = 1.0\nupper = 90.0\nunit = \"mNm\"\n";
    for serial in ["A", "B", "C", "D", "E", "REF"] {
        let mut new = run_of(&json!({"serial": serial, "part": "P"}), "Z");
        new["limits"] = limits.into();
        let (_, run) = daemon.post("/api/v1/runs", &new.to_string());
        daemon.wait_for_end(run["id"].as_i64().unwrap());
    }
    daemon.wait_for("/api/v1/units", |list| {
        list["units"].as_array().unwrap().iter().all(|one| !one["newest_limits"].is_null())
    });
    let (status, chart) = daemon.get("/api/v1/units/chart?search=part:P%20-unit:REF&procedure=friction&quantity=tau_c");
    let points = chart["points"].as_array().unwrap();
    let units: Vec<_> = points.iter().map(|point| point["unit"].as_str().unwrap()).collect();
    assert_eq!((status, units), (200, vec!["A", "B", "C", "D", "E"]), "without the reference unit: {chart}");
    assert!(points.iter().all(|point| point["violates"].as_array().unwrap().is_empty()), "{chart}");
    let capability = &chart["capability"];
    assert_eq!((&capability["lower"], &capability["upper"]), (&json!(0.001), &json!(0.09)), "in Nm: {chart}");
    let lowest = capability["cpk_ci95"][0].as_f64().unwrap();
    assert!(lowest > 1.0 && chart["sigma"].as_f64().unwrap() < 0.01, "{chart}");
    let viscous = json!({"name": "c_v", "title": "Viscous friction (motor)"});
    assert!(chart["quantities"].as_array().unwrap().contains(&viscous), "{chart}");

    let (status, other) = daemon.get("/api/v1/units/chart?procedure=friction&quantity=tau_x");
    assert_eq!((status, &other["empty"], &other["mean"]), (200, &json!("no_quantity"), &Value::Null), "{other}");
    assert_eq!((&other["quantities"], &other["points"]), (&chart["quantities"], &json!([])), "a choice: {other}");
    let (status, none) = daemon.get("/api/v1/units/chart?procedure=warm_up&quantity=tau_c");
    assert_eq!((status, &none["empty"], &none["quantities"]), (200, &json!("no_run"), &json!([])), "{none}");
}

/// The same mock joint five times: the last run changes nothing. Another setting is named, and is not compared.
#[test]
fn a_run_tells_what_changed_since_the_previous_run_of_its_unit() {
    let daemon = TestDaemon::start();
    let unit = json!({"serial": "SN \"5\""});
    let measure = |repeats: u32| {
        let mut new = run_of(&unit, "Z");
        new["parameters"]["repeats"] = repeats.into();
        let (status, run) = daemon.post("/api/v1/runs", &new.to_string());
        assert_eq!(status, 201, "{run}");
        let id = run["id"].as_i64().unwrap();
        daemon.wait_for_end(id);
        daemon.wait_for(&format!("/api/v1/runs/{id}"), |run| !run["verdict"].is_null());
        id
    };
    let first = measure(2);
    assert_eq!(daemon.get(&format!("/api/v1/runs/{first}/changes")), (200, Value::Null));
    let runs = [first, measure(2), measure(2), measure(2), measure(2)];
    let (_, changes) = daemon.get(&format!("/api/v1/runs/{}/changes", runs[4]));
    assert_eq!((&changes["previous_run"], &changes["comparable_runs"]), (&json!(runs[3]), &json!(4)), "{changes}");
    assert_eq!(changes["settings"], json!([]));
    let tau_c = changes["quantities"].as_array().unwrap().iter().find(|one| one["name"] == "tau_c").unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    let (low, high) = (number(&tau_c["prediction95"][0]), number(&tau_c["prediction95"][1]));
    assert!(low < number(&tau_c["present"]) && number(&tau_c["present"]) < high, "{tau_c}");
    let change = number(&tau_c["present"]) - number(&tau_c["previous"]);
    let middle = (number(&tau_c["change_ci95"][0]) + number(&tau_c["change_ci95"][1])) / 2.0;
    assert!((change - middle).abs() < 1e-12, "{tau_c}");

    let (_, changes) = daemon.get(&format!("/api/v1/runs/{}/changes", measure(3)));
    assert_eq!(changes["settings"], json!([{"parameter": "repeats", "previous": 2.0, "present": 3.0}]), "{changes}");
    assert_eq!(changes["comparable_runs"], 0);
    assert!(changes["quantities"][0]["prediction95"].is_null(), "{changes}");
}
