//! A run on the mock bench over HTTP, from start to end.

use crate::calibrations::made;
use crate::daemon::{BENCH, SHORT_RUN, TestDaemon, settings};
use jointbench::config::BenchDescription;
use jointbench::daemon::Daemon;
use jointbench::store::{NewRun, RunFilter, Store};
use jointbench_devices::{Joint, MockSettings};
use serde_json::{Value, json};
use tokio::runtime::Runtime;

fn start(daemon: &TestDaemon) -> i64 {
    let (status, run) = daemon.post("/api/v1/runs", SHORT_RUN);
    assert_eq!(status, 201, "{run}");
    run["id"].as_i64().unwrap()
}

/// The first page is complete, and `short` is that page alone.
fn check_first_page(daemon: &TestDaemon, id: i64, page: &str) {
    let (first, appendix) = page.split_once("<h1>Appendix</h1>").expect("an appendix");
    for part in ["95 % interval", "Model error (validation, RMS)", "<svg", "Signature of the operator"] {
        assert!(first.contains(part), "{part}: {first}");
    }
    assert!(appendix.contains("Provenance") && !first.contains("Provenance"), "{appendix}");
    let short = format!("/api/v1/runs/{id}/report?short=true");
    let short = daemon.get_raw(&short).body_mut().read_to_string().unwrap();
    assert!(first.starts_with(short.split("</main>").next().unwrap()), "the first page alone: {short}");
}

#[test]
fn a_run_is_measured_fitted_diagnosed_and_improved() {
    let daemon = TestDaemon::start();
    let preview = r#"{"bench": "joint-a-mock", "parameters": {}}"#;
    let (status, preview) = daemon.post("/api/v1/procedures/friction/preview", preview);
    assert_eq!(status, 200, "{preview}");
    assert!(preview["checks"].as_array().unwrap().iter().all(|check| check["ok"] == true), "{preview}");

    let id = start(&daemon);
    let run = daemon.wait_for_end(id);
    assert_eq!((&run["state"], &run["safe"]), (&"completed".into(), &"safe_verified".into()), "{run}");
    assert_eq!(run["provenance"]["seed"], 7);
    let rows = run["rows"].as_u64().unwrap();
    assert!(rows > 500, "{rows} rows");

    let (_, events) = daemon.get(&format!("/api/v1/runs/{id}/events"));
    let events = events.as_array().unwrap();
    let numbers: Vec<u64> = events.iter().map(|event| event["sequence"].as_u64().unwrap()).collect();
    assert_eq!(numbers, (1..=events.len() as u64).collect::<Vec<_>>(), "the journal has no gaps");
    assert!(events.iter().any(|event| event["kind"] == "safe"));

    let (_, samples) = daemon.get(&format!("/api/v1/runs/{id}/samples?px=100&channels=time_s,motor_velocity_rad_s"));
    assert_eq!((&samples["rows"], &samples["exact"]), (&rows.into(), &false.into()));

    let mut answer = daemon.get_raw(&format!("/api/v1/runs/{id}/report"));
    // The report has inline styles, which the dashboard's policy would block, and no scripts.
    let policy = answer.headers()["content-security-policy"].to_str().unwrap().to_owned();
    assert!(policy.contains("style-src 'unsafe-inline'") && !policy.contains("script"), "{policy}");
    let page = answer.body_mut().read_to_string().unwrap();
    assert!(page.contains("SIMULATED") && page.contains("Friction on joint-a-mock"), "{page}");
    assert!(page.contains("<th>torque constant</th><td>40.6 mNm/A</td>"), "{page}");

    let body = json!({ "run": id, "effects": ["inertia", "load_transmission", "coulomb", "viscous"] });
    let (status, model) = daemon.post("/api/v1/models", &body.to_string());
    assert_eq!(status, 201, "{model}");
    let (status, diagnosis) = daemon.post("/api/v1/diagnoses", &json!({ "model": model["id"] }).to_string());
    assert_eq!(status, 201, "{diagnosis}");
    assert_eq!((&diagnosis["model_id"], &diagnosis["fit"]), (&model["id"], &model["fit"]));
    let (status, set) = daemon.get(&format!("/api/v1/models/{}/residuals", model["id"]));
    assert_eq!(status, 200, "{set}");
    assert_eq!(set["measured"].as_array().unwrap().len(), set["error"].as_array().unwrap().len());
    assert_eq!(daemon.get(&format!("/api/v1/models/{}/residuals", model["id"])).1, set, "asked again, the same");

    let body = json!({ "run": id, "parent": model["id"],
        "effects": ["inertia", "load_transmission", "coulomb", "viscous", "direction_offset"] });
    let body_of_child = body.to_string();
    let (_, child) = daemon.post("/api/v1/models", &body_of_child);
    assert_eq!((&child["parent"], &child["added"]), (&model["id"], &json!(["direction_offset"])), "{child}");
    assert_eq!(daemon.get(&format!("/api/v1/models?run={id}")).1.as_array().unwrap().len(), 2);
    let mut body = json!({ "run": id, "parent": model["id"], "effects": model["effects"],
        "exclude": [{ "from_s": 0.0, "to_s": 0.5, "reason": "the cable was touched" }] });
    let (status, without) = daemon.post("/api/v1/models", &body.to_string());
    assert_eq!((status, &without["excluded"], &without["added"]), (201, &body["exclude"], &json!([])), "{without}");
    let (_, set) = daemon.get(&format!("/api/v1/models/{}/residuals", without["id"]));
    let marks = set["excluded"].as_array().unwrap();
    assert_eq!(marks.len(), set["error"].as_array().unwrap().len());
    assert!(marks.contains(&true.into()) && marks.contains(&false.into()), "shown, and marked");
    let child = json!({ "run": id, "parent": without["id"], "effects": ["coulomb", "viscous"] });
    assert_eq!(daemon.post("/api/v1/models", &child.to_string()).1["excluded"], body["exclude"], "as its parent");
    body["exclude"][0]["reason"] = " ".into();
    assert_eq!(daemon.post("/api/v1/models", &body.to_string()).0, 422, "nothing goes without a reason");

    let page = daemon.get_raw(&format!("/api/v1/runs/{id}/report")).body_mut().read_to_string().unwrap();
    assert!(page.contains("without samples: the cable was touched"), "{page}");
    let (_, child) = daemon.post("/api/v1/models", &body_of_child);
    assert_eq!((&child["excluded"], &child["idle"]), (&json!([]), &json!(true)), "{child}");
    let of = |model: &serde_json::Value| daemon.get_raw(&format!("/api/v1/runs/{id}/report?model={model}"));
    let page = of(&child["id"]).body_mut().read_to_string().unwrap();
    assert!(page.contains("+ Direction offset") && page.contains("noise floor"), "where the version came from");
    assert!(!page.contains("<script") && !page.contains("src="), "complete in itself");
    for part in ["Validation error before and after", "initial model", "Instruments", "Serial number", "Sign-off"] {
        assert!(page.contains(part), "{part}: {page}");
    }
    assert!(page.contains("Residual map over") || page.contains("No residual map: "), "{page}");
    let page = daemon.get_raw(&format!("/api/v1/runs/{id}/report")).body_mut().read_to_string().unwrap();
    assert!(!page.contains("+ Direction offset"), "an idle version is only shown on request");
    check_first_page(&daemon, id, &page);
    let page = of(&model["id"]).body_mut().read_to_string().unwrap();
    assert!(!page.contains("Direction offset") && page.contains("noise floor"), "an earlier version and its diagnosis");
    assert_eq!(of(&json!(99_999)).status(), 404, "of no other run");
}

#[test]
fn a_result_is_shown_with_earlier_results() {
    let daemon = TestDaemon::start();
    let earlier = |id: i64| daemon.get(&format!("/api/v1/runs/{id}/earlier"));
    let first = start(&daemon);
    daemon.wait_for_end(first);
    let aborted = start(&daemon);
    daemon.post(&format!("/api/v1/runs/{aborted}/abort"), "");
    assert_eq!(daemon.wait_for_end(aborted)["state"], "aborted");
    let [second, third] = [(); 2].map(|()| {
        let id = start(&daemon);
        assert_eq!(daemon.wait_for_end(id)["state"], "completed");
        id
    });
    assert_eq!(earlier(first), (200, json!([])));
    let (status, results) = earlier(third);
    let runs: Vec<_> = results.as_array().unwrap().iter().map(|one| one["run"].as_i64().unwrap()).collect();
    assert_eq!((status, runs), (200, vec![second, first]), "newest first, and none that was not finished: {results}");
    let (_, found) = daemon.get(&format!("/api/v1/runs/{first}/identification"));
    assert!(found["quantities"].as_array().unwrap().len() > 4, "{found}");
    assert_eq!(results[1]["quantities"], found["quantities"]);
    assert_eq!(earlier(third).1, results, "read where it was worked out");
    assert_eq!(earlier(second).1.as_array().unwrap().len(), 1);
    assert_eq!(earlier(77).0, 404);
    let (status, trends) = daemon.get("/api/v1/trends?search=procedure:friction");
    let all = trends["runs"].as_array().unwrap();
    assert_eq!((status, all.len()), (200, 3), "{trends}");
    assert!(all.iter().all(|one| one["temperature_c"].as_f64().is_some_and(|c| (15.0..60.0).contains(&c))), "{trends}");
    // The list is sorted by the same values; the aborted run has none and is last.
    let value = |run: &Value| {
        let quantities = run["quantities"].as_array().unwrap();
        quantities.iter().find(|one| one["name"] == "tau_c").unwrap()["value"].as_f64().unwrap()
    };
    let mut rising: Vec<(f64, i64)> = all.iter().map(|one| (value(one), one["run"].as_i64().unwrap())).collect();
    rising.sort_by(|a, b| a.0.total_cmp(&b.0));
    let listed = |sort: &str| -> Vec<i64> {
        let (status, list) = daemon.get(&format!("/api/v1/runs?sort={sort}"));
        assert_eq!(status, 200, "{list}");
        list["runs"].as_array().unwrap().iter().map(|run| run["id"].as_i64().unwrap()).collect()
    };
    let ids: Vec<i64> = rising.iter().map(|one| one.1).collect();
    assert_eq!(listed("quantity:tau_c"), [ids.clone(), vec![aborted]].concat());
    assert_eq!(listed("-quantity:tau_c"), [ids.into_iter().rev().collect(), vec![aborted]].concat());
    assert_eq!(listed("quantity:none"), [third, second, aborted, first], "without values the newest is first");
    assert_eq!(daemon.get("/api/v1/runs?sort=quantity:").0, 422);
}

#[test]
fn a_joint_that_was_not_warmed_up_is_a_warning_of_its_result() {
    let daemon = TestDaemon::start();
    let id = made(&daemon, "friction", json!({ "warm_up_s": 60.0, "load_levels": 1 }));
    let (_, events) = daemon.get(&format!("/api/v1/runs/{id}/events"));
    let warning = events.as_array().unwrap().iter().find(|event| event["kind"] == "warning").expect("a warning");
    assert!(warning["text"].as_str().unwrap().starts_with("not warmed up: "), "{warning}");
    let (_, found) = daemon.get(&format!("/api/v1/runs/{id}/identification"));
    assert_eq!(found["warnings"], json!([warning["text"]]), "{found}");
    assert!(["identified_with_warning", "inconclusive"].contains(&found["verdict"].as_str().unwrap()), "{found}");
    let page = daemon.get_raw(&format!("/api/v1/runs/{id}/report")).body_mut().read_to_string().unwrap();
    assert!(page.contains("not warmed up: "), "{page}");
}

/// The end of a run is stored shortly before its bench is free.
#[test]
fn the_next_run_can_start_when_a_run_is_shown_as_ended() {
    let daemon = TestDaemon::start();
    for _ in 0..8 {
        let id = start(&daemon);
        while daemon.get(&format!("/api/v1/runs/{id}")).1["safe"].is_null() {}
    }
}

#[test]
fn how_late_an_instrument_tells_is_in_the_journal_and_in_the_report() {
    let mock = MockSettings::new(Joint::EncoderShaft, 4);
    let daemon = TestDaemon::start_with(None, |settings| settings.benches = vec![BenchDescription::mock(BENCH, mock)]);
    let new = json!({ "bench": BENCH, "procedure": "encoder_delay",
        "parameters": { "top_speed_rad_s": 60.0, "speeds": 2, "repeats": 1, "dwell_s": 1.0 } });
    let (status, run) = daemon.post("/api/v1/runs", &new.to_string());
    assert_eq!(status, 201, "{run}");
    let id = run["id"].as_i64().unwrap();
    assert_eq!(daemon.wait_for_end(id)["state"], "completed");
    let (_, events) = daemon.get(&format!("/api/v1/runs/{id}/events"));
    let note = "Time stamps and signals agree";
    assert!(events.as_array().unwrap().iter().any(|event| event["text"].as_str().unwrap().contains(note)), "{events}");
    let page = daemon.get_raw(&format!("/api/v1/runs/{id}/report")).body_mut().read_to_string().unwrap();
    assert!(page.contains(note) && page.contains("Skew of the encoder under test"), "{page}");
}

#[test]
fn a_run_can_be_paused_resumed_and_stopped_and_the_bench_has_one_run() {
    let daemon = TestDaemon::start_with(Some(4.0), |_| {});
    let id = start(&daemon);
    let run = format!("/api/v1/runs/{id}");
    daemon.wait_for(&run, |run| run["state"] == "running");
    assert_eq!(daemon.post("/api/v1/runs", SHORT_RUN).0, 409);
    let early = daemon.post("/api/v1/models", &format!(r#"{{"run": {id}, "effects": ["coulomb"]}}"#));
    assert_eq!(early.0, 409, "half a run is no measurement: {}", early.1);
    assert_eq!(daemon.post(&format!("{run}/pause"), "").0, 200);
    daemon.wait_for(&run, |run| run["state"] == "paused");
    assert_eq!(daemon.get("/api/v1/bench").1[0]["state"], "paused");
    assert_eq!(daemon.post(&format!("{run}/resume"), "").0, 200);
    daemon.wait_for(&run, |run| run["state"] == "running");
    assert_eq!(daemon.post(&format!("{run}/stop"), "").0, 200);
    let ended = daemon.wait_for_end(id);
    assert_eq!((&ended["state"], &ended["safe"]), (&"stopped".into(), &"safe_verified".into()), "{ended}");
    assert_eq!(daemon.post(&format!("{run}/stop"), "").0, 409, "a run that is over cannot be steered");
    let (_, found) = daemon.get(&format!("{run}/identification"));
    assert_ne!(found["verdict"], "identified", "a part is not the whole: {found}");
    assert!(found["summary"].as_str().unwrap().contains("(stopped in step 1 of "), "{found}");
}

#[test]
fn what_is_left_of_a_stopped_run_is_made_later_and_both_are_one_measurement() {
    let daemon = TestDaemon::start();
    let whole = daemon.wait_for_end(start(&daemon));
    assert_eq!(whole["state"], "completed");
    let id = start(&daemon);
    let measured = |run: &Value| run["progress"]["step"].as_u64().is_some_and(|step| step > 20);
    daemon.wait_for(&format!("/api/v1/runs/{id}"), measured);
    assert_eq!(daemon.post(&format!("/api/v1/runs/{id}/continue"), "").0, 409, "it is still on");
    daemon.post(&format!("/api/v1/runs/{id}/abort"), "");
    assert_eq!(daemon.wait_for_end(id)["state"], "aborted");
    let (status, rest) = daemon.post(&format!("/api/v1/runs/{id}/continue"), "");
    assert_eq!(status, 201, "{rest}");
    let rest = daemon.wait_for_end(rest["id"].as_i64().unwrap());
    assert_eq!(rest["state"], "completed", "{rest}");
    let (status, plan) = daemon.get(&format!("/api/v1/runs/{}/plan", rest["id"]));
    assert_eq!(status, 200, "{plan}");
    let (_, events) = daemon.get(&format!("/api/v1/runs/{}/events", rest["id"]));
    let made: Vec<_> = events.as_array().unwrap().iter().filter(|event| event["kind"] == "step_started").collect();
    for event in &made {
        let step = event["data"]["step"].as_u64().unwrap() as usize;
        assert_eq!(plan["steps"][step]["label"], event["data"]["label"], "the reported plan is the executed plan");
    }
    let last = made.last().unwrap()["data"]["step"].as_u64().unwrap() as usize;
    assert_eq!(last + 1, plan["steps"].as_array().unwrap().len(), "{plan}");
    assert!(rest["rows"].as_u64().unwrap() < whole["rows"].as_u64().unwrap(), "only what was left, and its history");
    let found = |run: &Value| daemon.get(&format!("/api/v1/runs/{}/identification", run["id"])).1;
    let (uninterrupted, resumed) = (found(&whole), found(&rest));
    assert_eq!(resumed["verdict"], uninterrupted["verdict"], "{resumed}");
    let figures = |found: &Value| -> Vec<(String, Vec<f64>)> {
        let interval = |quantity: &Value| {
            quantity["ci95"].as_array().map(|ci95| ci95.iter().map(|end| end.as_f64().unwrap()).collect())
        };
        let quantities = found["quantities"].as_array().unwrap().iter();
        quantities.filter_map(|quantity| Some((quantity["name"].to_string(), interval(quantity)?))).collect()
    };
    let pairs: Vec<_> = figures(&uninterrupted).into_iter().zip(figures(&resumed)).collect();
    assert!(pairs.len() > 4, "{resumed}");
    for ((name, whole), (same, rest)) in pairs {
        assert_eq!(name, same);
        assert!(whole[0] <= rest[1] && rest[0] <= whole[1], "{name}: {rest:?} does not meet {whole:?}");
    }
    let both = format!("Runs {id} and {} together", rest["id"]);
    assert!(resumed["summary"].as_str().unwrap().starts_with(&both), "{resumed}");
    assert_eq!(daemon.post(&format!("/api/v1/runs/{}/continue", rest["id"]), "").0, 409, "nothing is left");
    let (status, twice) = daemon.post(&format!("/api/v1/runs/{id}/continue"), "");
    assert_eq!(status, 409, "{twice}");
    assert!(twice["detail"].as_str().unwrap().contains("already"), "{twice}");
}

#[test]
fn the_end_of_the_daemon_ends_a_run() {
    let mut daemon = TestDaemon::start_with(Some(4.0), |_| {});
    let id = start(&daemon);
    daemon.wait_for(&format!("/api/v1/runs/{id}"), |run| run["state"] == "running");
    daemon.stop();
    let record = Runtime::new().unwrap().block_on(async {
        let store = Store::open(daemon.data.path()).await.unwrap();
        store.run(id).await.unwrap()
    });
    assert_eq!(record.state.name(), "aborted");
    assert!(record.safe.is_some() && record.rows > 0, "{record:?}");
}

#[test]
fn an_interrupted_run_is_ended_secured_and_not_started_again() {
    let data = tempfile::TempDir::new().unwrap();
    let runtime = Runtime::new().unwrap();
    // The state after a daemon was killed: an open run.
    let id = runtime.block_on(async {
        let store = Store::open(data.path()).await.unwrap();
        let new =
            NewRun { bench: BENCH.into(), procedure: "friction".into(), kind: "friction".into(), ..NewRun::default() };
        let id = store.create_run(&new).await.unwrap();
        store.close().await;
        id
    });
    let run = runtime.block_on(async {
        let daemon = Daemon::start(settings(data.path(), None)).await.unwrap();
        let run = daemon.lab.run(id).await.unwrap();
        assert_eq!(
            daemon.lab.runs(&RunFilter { limit: 10, ..RunFilter::default() }).await.unwrap().total,
            1,
            "nothing was started"
        );
        daemon.stop().await;
        run
    });
    let run: Value = serde_json::to_value(run).unwrap();
    assert_eq!((&run["state"], &run["safe"]), (&"interrupted".into(), &"safe_verified".into()), "{run}");
    assert!(run["reason"].as_str().unwrap().contains("the daemon terminated during the run"));
}

#[test]
fn a_bench_that_may_be_unsafe_waits_for_a_person() {
    let data = tempfile::TempDir::new().unwrap();
    Runtime::new().unwrap().block_on(async {
        let store = Store::open(data.path()).await.unwrap();
        store.block_bench(BENCH, None, "the drive did not answer").await.unwrap();
        store.close().await;
    });
    let daemon = TestDaemon::start_with(None, |settings| settings.data = data.path().to_owned());
    let (status, problem) = daemon.post("/api/v1/runs", SHORT_RUN);
    assert_eq!(status, 409, "{problem}");
    assert!(problem["detail"].as_str().unwrap().contains("the drive did not answer"), "{problem}");
    let bench = format!("/api/v1/bench/{BENCH}");
    assert_eq!(daemon.get(&bench).1["blocked"]["reason"], "the drive did not answer");
    assert_eq!(daemon.post(&format!("{bench}/acknowledge"), r#"{"reason": " "}"#).0, 422);
    let (status, answer) = daemon.post(&format!("{bench}/acknowledge"), r#"{"reason": "cable was loose"}"#);
    assert_eq!((status, &answer["blocked"]), (200, &Value::Null), "{answer}");
    assert_eq!(daemon.post("/api/v1/runs", SHORT_RUN).0, 201);
}

#[test]
fn a_procedure_that_the_bench_cannot_run_has_a_reason() {
    let daemon = TestDaemon::start();
    let (_, procedures) = daemon.get(&format!("/api/v1/procedures?bench={BENCH}"));
    let refused =
        |id: &str| procedures.as_array().unwrap().iter().find(|one| one["id"] == id).unwrap()["refused"].clone();
    assert_eq!(refused("friction"), Value::Null);
    let encoder = refused("encoder_linearity");
    assert_eq!(encoder["reason"], "missing_instrument", "{encoder}");
    assert!(encoder["text"].as_str().unwrap().contains(BENCH), "{encoder}");
}
