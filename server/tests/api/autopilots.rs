//! Recommended next runs, executed with one request, and autopilots.

use crate::daemon::{BENCH, TestDaemon, settings};
use crate::import::upload;
use jointbench::config::BenchDescription;
use jointbench::daemon::Daemon;
use jointbench::store::Store;
use jointbench_devices::{Joint, MockSettings};
use serde_json::{Value, json};
use std::collections::HashSet;
use std::thread::JoinHandle;
use tokio::runtime::Runtime;
use tungstenite::Message;

/// A run without load cannot show load effects.
fn no_load() -> Value {
    json!({"load_levels": 1, "repeats": 2, "fast_speeds": 4, "dwell_s": 0.6, "warm_up_s": 1.0, "top_speed_rad_s": 120.0})
}

fn hiding(effects: &'static [&'static str], pace: Option<f64>) -> TestDaemon {
    TestDaemon::start_with(pace, |settings| {
        let mock = MockSettings { pace, ..MockSettings::new(Joint::JointA, 7) }.hiding(effects);
        settings.benches = vec![BenchDescription::mock(BENCH, mock)];
    })
}

fn start(daemon: &TestDaemon, body: &Value) -> i64 {
    let (status, autopilot) = daemon.post("/api/v1/autopilots", &body.to_string());
    assert_eq!(status, 201, "{autopilot}");
    autopilot["id"].as_i64().unwrap()
}

fn wait(daemon: &TestDaemon, id: i64) -> Value {
    daemon.wait_for(&format!("/api/v1/autopilots/{id}"), |a| a["state"] != "running")
}

/// Counts the autopilot steps in the live stream until the autopilot ends.
fn listen(daemon: &TestDaemon) -> JoinHandle<usize> {
    let (mut socket, _) = tungstenite::connect(format!("ws://{}/api/v1/events", daemon.address())).unwrap();
    std::thread::spawn(move || {
        let mut sequences = HashSet::new();
        loop {
            let Message::Text(text) = socket.read().unwrap() else { continue };
            let message: Value = serde_json::from_str(&text).unwrap();
            match (&message["type"], message["step"]["sequence"].as_u64()) {
                (kind, _) if kind != "autopilot" => continue,
                (_, Some(sequence)) => sequences.insert(sequence),
                _ => return sequences.len(),
            };
        }
    })
}

fn added(daemon: &TestDaemon, autopilot: &Value) -> Vec<String> {
    let (_, model) = daemon.get(&format!("/api/v1/models/{}", autopilot["model"]));
    let baseline = ["inertia", "load_transmission", "coulomb", "viscous"];
    let effects = model["effects"].as_array().unwrap().iter().filter_map(Value::as_str);
    effects.filter(|effect| !baseline.contains(effect)).map(str::to_owned).collect()
}

#[test]
fn an_effect_that_one_run_cannot_show_is_found_by_the_next() {
    let daemon = hiding(&["load_linear"], None);
    let listener = listen(&daemon);
    let id = start(&daemon, &json!({"bench": BENCH, "runs": 3, "parameters": no_load()}));
    let ended = wait(&daemon, id);
    let steps = ended["steps"].as_array().unwrap();
    let story: Vec<&str> = steps.iter().filter_map(|step| step["text"].as_str()).collect();
    assert_eq!((&ended["state"], &ended["verdict"]), (&"finished".into(), &"adequate".into()), "{story:#?}");
    assert_eq!(added(&daemon, &ended), ["load_linear"], "{story:#?}");
    assert!(ended["runs"].as_array().unwrap().len() > 1, "one run could not have shown it: {story:#?}");

    let second = steps.iter().filter(|step| step["action"] == "measure").nth(1).unwrap();
    let separates = second["experiment"]["separates"].as_array().unwrap();
    assert!(separates.contains(&"load_linear".into()), "{second}");
    assert!(second["experiment"]["expected_z"].as_f64().unwrap() >= 4.0, "{second}");
    let add = steps.iter().find(|step| step["action"] == "add" && step["effect"] == "load_linear").unwrap();
    assert!(add["after_rms"].as_f64().unwrap() < add["before_rms"].as_f64().unwrap(), "{add}");

    let (_, model) = daemon.get(&format!("/api/v1/models/{}", ended["model"]));
    assert_eq!((&model["run"], &model["more_runs"][0]), (&ended["runs"][0], &ended["runs"][1]), "{model}");
    let (status, set) = daemon.get(&format!("/api/v1/models/{}/residuals", ended["model"]));
    assert_eq!(status, 200, "{set}");

    assert_eq!(listener.join().unwrap(), steps.len(), "every step is published when it is made");
}

#[test]
fn the_run_that_a_diagnosis_asks_for_is_one_call() {
    let daemon = hiding(&["load_linear"], None);
    let body = json!({"bench": BENCH, "procedure": "friction", "parameters": no_load()});
    let (_, run) = daemon.post("/api/v1/runs", &body.to_string());
    daemon.wait_for_end(run["id"].as_i64().unwrap());
    let body = json!({"run": run["id"], "effects": ["inertia", "load_transmission", "coulomb", "viscous"]});
    let (_, model) = daemon.post("/api/v1/models", &body.to_string());
    let (_, before) = daemon.post("/api/v1/diagnoses", &json!({"model": model["id"]}).to_string());
    assert_eq!(before["suggestions"], json!([]), "{}", before["summary"]);
    let separates = before["experiment"]["separates"].as_array().unwrap();
    assert!(separates.contains(&"load_linear".into()), "{}", before["experiment"]);

    let raw = |what: &str| {
        daemon.get_raw(&format!("/api/v1/runs/{}/{what}", run["id"])).into_body().read_to_string().unwrap()
    };
    let table = raw("export?format=csv");
    let other = raw("meta").replace("177.8", "100");
    let (_, stranger) = upload(&daemon, &table, &[("meta", &other)]);
    assert_eq!((&stranger["simulated"], &stranger["meta"]["simulated"]), (&true.into(), &Value::Null), "{stranger}");
    let body = json!({"run": stranger["id"], "effects": model["effects"]});
    let (_, its_model) = daemon.post("/api/v1/models", &body.to_string());
    let (_, found) = daemon.post("/api/v1/diagnoses", &json!({"model": its_model["id"]}).to_string());
    let path = format!("/api/v1/diagnoses/{}/experiment", found["id"]);
    let (status, problem) = daemon.post(&path, &json!({"bench": BENCH}).to_string());
    assert_eq!(status, 422, "{problem}");
    assert!(problem["detail"].as_str().unwrap().contains("gear ratio = 177.8, in the run 100"), "{problem}");

    let (status, none) = daemon.get(&format!("/api/v1/runs/{}/beside", run["id"]));
    assert_eq!((status, none), (200, Value::Null), "no other run of its bench has a model");
    let share_outside = |parameters: Value| {
        let body = json!({"bench": BENCH, "procedure": "friction", "parameters": parameters});
        let (_, run) = daemon.post("/api/v1/runs", &body.to_string());
        daemon.wait_for_end(run["id"].as_i64().unwrap());
        let (_, overlay) = daemon.get(&format!("/api/v1/runs/{}/beside", run["id"]));
        overlay["outside"].as_f64().unwrap()
    };
    let unloaded = share_outside(no_load());
    assert!(unloaded < 0.12, "{unloaded}");
    let mut loaded = no_load();
    loaded["load_levels"] = 3.into();
    let loaded = share_outside(loaded);
    assert!(loaded > 0.3, "what the model lacks leaves the band: {loaded}");

    let path = format!("/api/v1/diagnoses/{}/experiment", before["id"]);
    let (status, autopilot) = daemon.post(&path, &json!({"bench": BENCH}).to_string());
    assert_eq!(status, 201, "{autopilot}");
    let ended = wait(&daemon, autopilot["id"].as_i64().unwrap());
    assert_eq!((&ended["state"], &ended["request"]["diagnosis"]), (&"finished".into(), &before["id"]), "{ended}");
    let (_, again) = daemon.get(&format!("/api/v1/models/{}", ended["model"]));
    assert_eq!((&again["parent"], &again["run"]), (&model["id"], &run["id"]), "{again}");
    assert_eq!((&again["more_runs"], &again["effects"]), (&ended["runs"], &model["effects"]), "{again}");
    let (_, after) = daemon.post("/api/v1/diagnoses", &json!({"model": again["id"]}).to_string());
    assert_eq!(after["suggestions"][0]["effect"], "load_linear", "{}", after["summary"]);

    let (_, set) = daemon.get(&format!("/api/v1/models/{}/residuals", again["id"]));
    let (status, shape) = daemon.get(&format!("/api/v1/models/{}/with/load_linear", again["id"]));
    assert_eq!(status, 200, "{shape}");
    let numbers = |list: &Value| list.as_array().unwrap().iter().filter_map(Value::as_f64).collect::<Vec<_>>();
    let (error, shape) = (numbers(&set["error"]), numbers(&shape));
    assert_eq!(error.len(), shape.len());
    let fitted: Vec<usize> = (0..error.len()).filter(|i| set["held_out"][i] == false).collect();
    let left: f64 = fitted.iter().map(|&i| (error[i] - shape[i]).powi(2)).sum();
    let whole: f64 = fitted.iter().map(|&i| error[i].powi(2)).sum();
    assert!(left < 0.5 * whole, "the shape lies on the residual: {left} of {whole}");
}

#[test]
fn an_autopilot_begins_with_the_run_that_is_there() {
    let daemon = hiding(&["load_linear"], None);
    let (_, run) = daemon
        .post("/api/v1/runs", &json!({"bench": BENCH, "procedure": "friction", "parameters": no_load()}).to_string());
    daemon.wait_for_end(run["id"].as_i64().unwrap());
    let body = json!({"run": run["id"], "effects": ["inertia", "load_transmission", "coulomb", "viscous"]});
    let (_, model) = daemon.post("/api/v1/models", &body.to_string());
    let id = start(&daemon, &json!({"bench": BENCH, "runs": 1, "from_run": run["id"], "effects": body["effects"]}));
    let ended = wait(&daemon, id);
    assert_eq!((&ended["steps"][0]["action"], &ended["steps"][0]["model"]), (&"fit".into(), &model["id"]), "{ended}");
    assert_eq!(ended["runs"].as_array().unwrap().len(), 1, "one further run: {ended}");
    assert_eq!(added(&daemon, &ended), ["load_linear"], "{ended}");
    let (_, last) = daemon.get(&format!("/api/v1/models/{}", ended["model"]));
    assert_eq!((&last["run"], &last["more_runs"]), (&run["id"], &ended["runs"]), "{last}");
}

#[test]
fn an_autopilot_adds_nothing_to_columns_that_contradict_each_other() {
    let daemon = hiding(&["stribeck"], None);
    let body = json!({"bench": BENCH, "procedure": "friction"});
    let (_, run) = daemon.post("/api/v1/runs", &body.to_string());
    daemon.wait_for_end(run["id"].as_i64().unwrap());
    let raw = |what: &str| {
        daemon.get_raw(&format!("/api/v1/runs/{}/{what}", run["id"])).into_body().read_to_string().unwrap()
    };
    let (_, broken) =
        upload(&daemon, &raw("export?format=csv"), &[("meta", &raw("meta")), ("scale", "motor_current_a=1000")]);
    let body = json!({"bench": BENCH, "runs": 2, "from_run": broken["id"]});
    let ended = wait(&daemon, start(&daemon, &body));
    let actions: Vec<&str> = ended["steps"].as_array().unwrap().iter().filter_map(|s| s["action"].as_str()).collect();
    assert_eq!((actions.as_slice(), &ended["state"]), (&["fit"][..], &"finished".into()), "{ended}");
    let reason = ended["reason"].as_str().unwrap();
    assert!(reason.starts_with("Data problem: ") && reason.contains("Correct this first"), "{reason}");
}

#[test]
fn an_autopilot_is_stopped_by_a_person_and_interrupted_with_its_daemon() {
    let mut daemon = hiding(&[], Some(4.0));
    let body = json!({"bench": BENCH, "parameters": no_load()});
    let (_, preview) = daemon.post("/api/v1/procedures/friction/preview", &body.to_string());
    assert_eq!(preview["wait_s"].as_f64().unwrap(), preview["duration_s"].as_f64().unwrap() / 4.0);
    let (status, problem) = daemon.post("/api/v1/autopilots", &json!({"bench": BENCH, "from_run": 99}).to_string());
    assert_eq!(status, 404, "{problem}");
    let id = start(&daemon, &body);
    let path = format!("/api/v1/autopilots/{id}");
    assert_eq!(daemon.post("/api/v1/autopilots", &body.to_string()).0, 409, "one for each bench");
    let flying = daemon.wait_for(&path, |a| a["runs"].as_array().is_some_and(|runs| !runs.is_empty()));
    let run = flying["runs"][0].as_i64().unwrap();
    daemon.wait_for(&format!("/api/v1/runs/{run}"), |run| run["state"] == "running");
    assert_eq!(daemon.post(&format!("{path}/stop"), "").0, 200);
    let ended = wait(&daemon, id);
    assert_eq!(ended["state"], "stopped", "{ended}");
    assert_eq!(daemon.wait_for_end(run)["state"], "stopped");
    assert_eq!(daemon.post(&format!("{path}/stop"), "").0, 409);

    let id = start(&daemon, &body);
    let path = format!("/api/v1/autopilots/{id}");
    daemon.wait_for(&path, |a| a["runs"].as_array().is_some_and(|runs| !runs.is_empty()));
    daemon.stop();
    let state = Runtime::new().unwrap().block_on(async {
        let store = Store::open(daemon.data.path()).await.unwrap();
        store.autopilot(id).await.unwrap().state
    });
    assert_eq!(state, "interrupted");
}

#[test]
fn what_a_killed_daemon_left_open_is_interrupted_and_not_taken_up() {
    let data = tempfile::TempDir::new().unwrap();
    let runtime = Runtime::new().unwrap();
    let autopilot = runtime.block_on(async {
        let store = Store::open(data.path()).await.unwrap();
        let id = store.create_autopilot(BENCH, &serde_json::Map::new(), "running").await.unwrap();
        store.close().await;
        let daemon = Daemon::start(settings(data.path(), None)).await.unwrap();
        let autopilot = daemon.lab.autopilot(id).await.unwrap();
        daemon.stop().await;
        autopilot
    });
    let view = serde_json::to_value(&autopilot).unwrap();
    assert_eq!((&view["state"], &view["runs"]), (&"interrupted".into(), &json!([])), "{view}");
    assert!(view["reason"].as_str().unwrap().contains("the daemon terminated"), "{view}");
}

#[test]
fn what_cannot_be_asked_of_an_autopilot_is_refused_before_anything_moves() {
    let daemon = TestDaemon::start();
    for (body, status, expected) in [
        (json!({"bench": "attic"}), 404, "bench attic does not exist"),
        (json!({"bench": BENCH, "runs": 0}), 422, "runs = 0"),
        (json!({"bench": BENCH, "bench_time_s": 5.0}), 422, "the first run alone"),
        (json!({"bench": BENCH, "parameters": {"top_speed_rad_s": 900}}), 422, "motor velocity"),
        (json!({"bench": BENCH, "effects": ["belt"]}), 422, "effect belt"),
    ] {
        let (found, problem) = daemon.post("/api/v1/autopilots", &body.to_string());
        assert_eq!(found, status, "{problem}");
        assert!(problem["detail"].as_str().unwrap().contains(expected), "{problem}");
    }
    assert_eq!(daemon.post("/api/v1/diagnoses/9/experiment", r#"{"bench": "joint-a-mock"}"#).0, 404);
    assert_eq!(daemon.get("/api/v1/autopilots/9").0, 404);
    assert_eq!(daemon.get("/api/v1/autopilots").1, json!([]));
    assert_eq!(daemon.get("/api/v1/runs").1["total"], 0);
}
