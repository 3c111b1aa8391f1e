//! Queues: order, plans, pauses and leases.

use crate::daemon::{BENCH, SHORT_RUN, TestDaemon};
use serde_json::{Value, json};
use std::time::Duration;

fn short(more: Value) -> Value {
    let mut new: Value = serde_json::from_str(SHORT_RUN).unwrap();
    new.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    new
}

fn queued(daemon: &TestDaemon, more: Value) -> i64 {
    let mut new = short(more);
    new["queue"] = true.into();
    let (status, entry) = daemon.post("/api/v1/runs", &new.to_string());
    assert_eq!((status, &entry["state"]), (202, &json!("waiting")), "{entry}");
    entry["id"].as_i64().unwrap()
}

fn switch(daemon: &TestDaemon, how: &str) {
    let (status, queue) = daemon.post(&format!("/api/v1/bench/{BENCH}/queue/{how}"), "");
    assert_eq!((status, queue["paused"].is_null()), (200, how == "resume"), "{queue}");
}

/// Waits until an entry is a run, and returns the run.
fn run_of(daemon: &TestDaemon, entry: i64) -> i64 {
    daemon.wait_for(&format!("/api/v1/queue/{entry}"), |entry| entry["run"].is_i64())["run"].as_i64().unwrap()
}

fn paused(daemon: &TestDaemon) -> String {
    let queues = daemon.wait_for("/api/v1/queue", |queues| queues[0]["paused"].is_object());
    queues[0]["paused"]["reason"].as_str().unwrap().to_owned()
}

#[test]
fn waiting_runs_start_by_priority_and_age() {
    let daemon = TestDaemon::start();
    switch(&daemon, "pause");
    let old = queued(&daemon, json!({"note": "first day"}));
    let urgent = queued(&daemon, json!({"priority": 2, "unit": {"serial": "SN7"}}));
    let young = queued(&daemon, json!({}));
    let removed = queued(&daemon, json!({}));
    let order = || {
        let (_, queues) = daemon.get("/api/v1/queue");
        queues[0]["entries"].as_array().unwrap().iter().map(|entry| entry["id"].as_i64().unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(order(), [urgent, old, young, removed]);
    assert_eq!(daemon.delete(&format!("/api/v1/queue/{removed}")).1["state"], "removed");
    assert_eq!(daemon.delete(&format!("/api/v1/queue/{removed}")).0, 409);
    let priority = (format!("/api/v1/queue/{young}/priority"), br#"{"priority": 1}"#);
    assert_eq!(daemon.put_with(&priority.0, priority.1, &[("content-type", "application/json")]).0, 200);
    assert_eq!(order(), [urgent, young, old]);

    switch(&daemon, "resume");
    let runs = [urgent, young, old].map(|entry| run_of(&daemon, entry));
    assert!(runs[0] < runs[1] && runs[1] < runs[2], "{runs:?}");
    assert_eq!(daemon.wait_for_end(runs[0])["unit"]["serial"], "SN7");
    assert_eq!(daemon.wait_for_end(runs[2])["state"], "completed");
    assert_eq!(daemon.get(&format!("/api/v1/runs/{}/notes", runs[2])).1[0]["text"], "first day");
    assert_eq!(daemon.put_with(&priority.0, priority.1, &[("content-type", "application/json")]).0, 409);
}

#[test]
fn a_repeated_request_is_queued_once() {
    let daemon = TestDaemon::start();
    switch(&daemon, "pause");
    let post = |more: Value| {
        let headers = [("content-type", "application/json"), ("idempotency-key", "job 17")];
        daemon.post_with("/api/v1/runs", short(more).to_string().as_bytes(), &headers)
    };
    let (status, first) = post(json!({"queue": true}));
    assert_eq!(status, 202, "{first}");
    assert_eq!(post(json!({"queue": true})).1["id"], first["id"]);
    let (status, other) = post(json!({"queue": true, "operator": "Ada"}));
    assert_eq!(status, 409, "{other}");
    assert_eq!(post(json!({})).0, 400, "a run that does not wait is not repeated safely");
    let (status, wrong) = daemon.post("/api/v1/runs", &short(json!({"queue": true, "lease_s": 0})).to_string());
    assert!(status == 422 && wrong["detail"].as_str().unwrap().contains("lease_s"), "{wrong}");
}

#[test]
fn repeated_requests_at_the_same_time_are_queued_once() {
    let daemon = TestDaemon::start();
    switch(&daemon, "pause");
    let body = short(json!({"queue": true})).to_string();
    let headers = [("content-type", "application/json"), ("idempotency-key", "once")];
    std::thread::scope(|scope| {
        let post = || daemon.post_with("/api/v1/runs", body.as_bytes(), &headers);
        let answers: Vec<_> = (0..12).map(|_| scope.spawn(post)).collect();
        for answer in answers {
            let (status, entry) = answer.join().unwrap();
            assert_eq!((status, &entry["id"]), (202, &json!(1)), "{entry}");
        }
    });
}

/// Runs of a test plan stay together and in order, whatever their priority; a person mounts another unit.
#[test]
fn a_test_plan_stays_together_and_another_unit_needs_a_person() {
    let daemon = TestDaemon::start();
    switch(&daemon, "pause");
    let unit = |serial: &str| json!({"unit": {"serial": serial}});
    let plan = json!({"runs": [short(unit("SN1")), short(unit("SN1"))]});
    let (_, entries) = daemon.post("/api/v1/queue", &plan.to_string());
    let [first, second] = [0, 1].map(|i| entries[i]["id"].as_i64().unwrap());
    let other = queued(&daemon, json!({"unit": {"serial": "SN2"}, "priority": 1}));
    let priority = format!("/api/v1/queue/{second}/priority");
    let changed = daemon.put_with(&priority, br#"{"priority": 2}"#, &[("content-type", "application/json")]);
    assert_eq!(changed.0, 200, "{}", changed.1);
    let (_, queues) = daemon.get("/api/v1/queue");
    let order: Vec<_> = queues[0]["entries"].as_array().unwrap().iter().map(|entry| entry["id"].as_i64()).collect();
    assert_eq!(order, [Some(first), Some(second), Some(other)]);
    switch(&daemon, "resume");
    assert_eq!(paused(&daemon), "the next run is of unit SN2: mount it in place of SN1");
    assert!(run_of(&daemon, first) < run_of(&daemon, second));
    switch(&daemon, "resume");
    daemon.wait_for_end(run_of(&daemon, other));

    let units = json!({"runs": [short(unit("SN1")), short(unit("SN2"))]});
    assert_eq!(daemon.post("/api/v1/queue", &units.to_string()).0, 422);
}

#[test]
fn a_waiting_run_whose_client_is_gone_leaves_the_queue() {
    let daemon = TestDaemon::start();
    switch(&daemon, "pause");
    let entry = queued(&daemon, json!({"lease_s": 4.0}));
    for _ in 0..5 {
        std::thread::sleep(Duration::from_secs(1));
        assert_eq!(daemon.post(&format!("/api/v1/queue/{entry}/lease"), "").0, 200);
    }
    let left = daemon.wait_for(&format!("/api/v1/queue/{entry}"), |entry| entry["state"] == "removed");
    assert_eq!(left["reason"], "lease not renewed for 4 s");
    assert_eq!(daemon.post(&format!("/api/v1/queue/{entry}/lease"), "").0, 409);
}

#[test]
fn nothing_moves_after_an_aborted_run_a_software_stop_or_a_restart() {
    let mut daemon = TestDaemon::start_with(Some(1.0), |_| {});
    let (_, run) = daemon.post("/api/v1/runs", SHORT_RUN);
    let entry = queued(&daemon, json!({}));
    let waiting =
        daemon.wait_for("/api/v1/queue", |queues| queues[0]["entries"][0]["starts_in_s"].as_f64() > Some(1.0));
    assert!(waiting[0]["entries"][0]["planned_s"].as_f64() > Some(5.0), "{waiting}");
    daemon.post(&format!("/api/v1/runs/{}/abort", run["id"]), "");
    assert_eq!(paused(&daemon), format!("run {} is aborted: inspect the bench", run["id"]));

    daemon.post(&format!("/api/v1/bench/{BENCH}/stop"), "");
    let (status, refused) = daemon.post(&format!("/api/v1/bench/{BENCH}/queue/resume"), "");
    assert!(status == 409 && refused["detail"].as_str().unwrap().contains("software stop pressed"), "{refused}");
    daemon.post(&format!("/api/v1/bench/{BENCH}/acknowledge"), r#"{"reason": "inspected"}"#);
    switch(&daemon, "resume");
    let run = run_of(&daemon, entry);
    let next = queued(&daemon, json!({}));

    daemon.restart(None);
    assert!(paused(&daemon).contains("the daemon was restarted"));
    assert_eq!(daemon.get(&format!("/api/v1/runs/{run}")).1["state"], "aborted");
    assert_eq!(daemon.get(&format!("/api/v1/queue/{next}")).1["state"], "waiting");
    switch(&daemon, "resume");
    assert_eq!(daemon.wait_for_end(run_of(&daemon, next))["state"], "completed");
}

#[test]
fn a_plan_proceeds_only_if_its_runs_meet_the_condition() {
    let daemon = TestDaemon::start();
    let limits = "[[limit]]\nquantity = \"c_v\"\nupper = 1e-9\nunit = \"Nm·s/rad\"\n";
    let plan = |proceed_if: &str| {
        let runs = [short(json!({"limits": limits})), short(json!({}))];
        json!({"proceed_if": proceed_if, "runs": runs}).to_string()
    };
    let entries = |proceed_if: &str| {
        let (status, entries) = daemon.post("/api/v1/queue", &plan(proceed_if));
        assert_eq!(status, 201, "{entries}");
        let id = |i: usize| entries[i]["id"].as_i64().unwrap();
        assert_eq!((&entries[0]["plan"], &entries[1]["plan"]), (&json!(id(0)), &json!(id(0))));
        [id(0), id(1)]
    };
    let [first, second] = entries("pass");
    let left = daemon.wait_for(&format!("/api/v1/queue/{second}"), |entry| entry["state"] == "removed");
    let run = run_of(&daemon, first);
    assert_eq!(left["reason"], format!("the limits of run {run} of the test plan are not met: fail"));
    let [_, second] = entries("identified");
    run_of(&daemon, second);

    let unknown = json!({"runs": [short(json!({})), short(json!({"procedure": "frictoin"}))]}).to_string();
    let (status, refused) = daemon.post("/api/v1/queue", &unknown);
    assert!(status == 404 && refused["detail"].as_str().unwrap().starts_with("run 2 of the test plan"), "{refused}");
    assert_eq!(daemon.post("/api/v1/queue", r#"{"runs": []}"#).0, 422);
    daemon.wait_for("/api/v1/queue", |queues| queues[0]["entries"] == json!([]));
}

#[test]
fn a_run_whose_client_is_gone_ends_and_the_queue_proceeds() {
    let daemon = TestDaemon::start_with(Some(1.0), |_| {});
    let (status, run) = daemon.post("/api/v1/runs", &short(json!({"lease_s": 4.0})).to_string());
    assert_eq!(status, 201, "{run}");
    let id = run["id"].as_i64().unwrap();
    let next = queued(&daemon, json!({}));
    let lease = format!("/api/v1/runs/{id}/lease");
    for _ in 0..5 {
        std::thread::sleep(Duration::from_secs(1));
        assert_eq!(daemon.post(&lease, "").1, json!({"expires_in_s": 4.0}));
    }
    let ended = daemon.wait_for_end(id);
    assert_eq!(ended["state"], "stopped", "{ended}");
    assert_eq!(ended["reason"], "stopped because no client controlled the run");
    let (_, journal) = daemon.get(&format!("/api/v1/runs/{id}/events"));
    assert!(journal.to_string().contains("no client controls the run (lease not renewed for 4 s)"), "{journal}");
    assert_eq!(daemon.post(&lease, "").0, 409);
    let run = run_of(&daemon, next);
    assert_eq!(daemon.post(&format!("/api/v1/runs/{run}/lease"), "").0, 409, "a run without a lease");
}

#[test]
fn entries_that_left_the_queue_stay_visible_and_a_removal_is_undone() {
    let mut daemon = TestDaemon::start();
    switch(&daemon, "pause");
    let first = queued(&daemon, json!({}));
    let second = queued(&daemon, json!({"unit": {"serial": "SN2"}}));
    let third = queued(&daemon, json!({}));
    let queue = |daemon: &TestDaemon| daemon.get("/api/v1/queue").1[0].clone();
    let ids = |list: &Value| list.as_array().unwrap().iter().map(|one| one["id"].as_i64().unwrap()).collect::<Vec<_>>();
    assert_eq!(daemon.delete(&format!("/api/v1/queue/{second}")).0, 200);
    let left = queue(&daemon)["left"].clone();
    assert_eq!(
        (ids(&left), &left[0]["state"], &left[0]["reason"]),
        (vec![second], &json!("removed"), &json!("requested by local"))
    );

    let restore = |daemon: &TestDaemon, entry: i64| daemon.post(&format!("/api/v1/queue/{entry}/restore"), "");
    let (status, restored) = restore(&daemon, second);
    assert_eq!((status, &restored["state"], &restored["reason"]), (200, &json!("waiting"), &Value::Null), "{restored}");
    assert_eq!(ids(&queue(&daemon)["entries"]), [first, second, third], "in its former place");
    let (status, refused) = restore(&daemon, second);
    assert!(status == 409 && refused["detail"].as_str().unwrap().contains("is waiting"), "{refused}");
    assert_eq!(restore(&daemon, 77).0, 404);

    daemon.delete(&format!("/api/v1/queue/{third}"));
    switch(&daemon, "resume");
    daemon.wait_for_end(run_of(&daemon, first));
    daemon.wait_for_end(run_of(&daemon, second));
    daemon.restart(None);
    let left = queue(&daemon)["left"].clone();
    assert_eq!(ids(&left), [second, first, third], "the newest first, also after a restart: {left}");
    assert_eq!((&left[0]["run_state"], &left[2]["run_state"]), (&json!("completed"), &Value::Null), "{left}");
}
