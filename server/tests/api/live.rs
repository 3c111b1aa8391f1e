//! The live stream.

use crate::daemon::{SHORT_RUN, TestDaemon};
use serde_json::Value;
use std::collections::BTreeMap;
use tungstenite::Message;

#[test]
fn a_run_is_streamed_live() {
    let daemon = TestDaemon::start_with(Some(20.0), |_| {});
    let (mut socket, _) = tungstenite::connect(format!("ws://{}/api/v1/events", daemon.address())).unwrap();
    let (status, run) = daemon.post("/api/v1/runs", SHORT_RUN);
    assert_eq!(status, 201, "{run}");
    let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
    let (mut channels, mut rows, mut next, mut newest_s) = (0, 0, 0, f64::NEG_INFINITY);
    loop {
        match socket.read().unwrap() {
            Message::Text(text) => {
                let message: Value = serde_json::from_str(&text).unwrap();
                let kind = message["type"].as_str().unwrap().to_owned();
                if kind == "channels" {
                    channels = message["channels"].as_array().unwrap().len();
                }
                if kind == "state" && !message["safe"].is_null() {
                    assert_eq!((&message["state"], &message["run"]), (&"completed".into(), &run["id"]));
                }
                let judged = kind == "verdict";
                *kinds.entry(kind).or_default() += 1;
                if judged {
                    assert_eq!(message["run"], run["id"]);
                    break;
                }
            }
            Message::Binary(frame) => {
                let word = |i: usize| u32::from_le_bytes(frame[4 * i..4 * i + 4].try_into().unwrap());
                assert_eq!(word(0), next, "frames are numbered");
                assert_eq!((word(1), word(3) as usize), (0, channels), "nothing is dropped for a quick client");
                assert_eq!(frame.len(), 24 + 4 * word(2) as usize * channels);
                let t0_s = f64::from_le_bytes(frame[16..24].try_into().unwrap());
                assert!(t0_s > newest_s, "{t0_s} s after {newest_s} s");
                newest_s = t0_s;
                next += 1;
                rows += word(2);
            }
            Message::Ping(_) => {}
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(channels, 13);
    assert!(rows > 500 && next > 2, "{rows} rows in {next} frames");
    for kind in ["bench", "state", "progress", "event", "channels", "verdict"] {
        assert!(kinds.contains_key(kind), "{kind} in {kinds:?}");
    }
}

#[test]
fn a_request_that_opens_no_socket_is_a_problem() {
    let daemon = TestDaemon::start();
    let (status, problem) = daemon.get("/api/v1/events");
    assert_eq!((status, &problem["type"]), (400, &"urn:jointbench:malformed".into()), "{problem}");
    assert!(problem["detail"].as_str().unwrap().contains("WebSocket"), "{problem}");
}

#[test]
fn a_new_effect_is_published_to_all_clients() {
    let daemon = TestDaemon::start();
    let (mut socket, _) = tungstenite::connect(format!("ws://{}/api/v1/events", daemon.address())).unwrap();
    let effect = r#"{"id": "rub", "kind": "friction", "formula": "tau = a * velocity", "parameters": [{"name": "a"}]}"#;
    assert_eq!(daemon.post("/api/v1/effects", effect).0, 201);
    let message = loop {
        if let Message::Text(text) = socket.read().unwrap() {
            let message: Value = serde_json::from_str(&text).unwrap();
            if message["type"] == "effects" {
                break message;
            }
        }
    };
    assert_eq!((&message["kind"], &message["effect"]), (&"friction".into(), &"rub".into()));
}

#[test]
fn a_stream_ends_when_its_token_is_revoked() {
    let daemon = TestDaemon::start();
    let (_, made) = daemon.post("/api/v1/tokens", r#"{"name": "wall screen", "access": "read"}"#);
    let address = format!("ws://{}/api/v1/events?token={}", daemon.address(), made["secret"].as_str().unwrap());
    let (mut socket, _) = tungstenite::connect(address).unwrap();
    socket.read().unwrap();
    assert_eq!(daemon.delete(&format!("/api/v1/tokens/{}", made["id"])).0, 204);
    while socket.read().is_ok() {}
}

#[test]
fn the_last_model_of_the_bench_goes_along_with_a_run() {
    let daemon = TestDaemon::start();
    let (_, first) = daemon.post("/api/v1/runs", SHORT_RUN);
    daemon.wait_for_end(first["id"].as_i64().unwrap());
    let fit = serde_json::json!({"run": first["id"], "effects": ["inertia", "coulomb", "viscous", "load_linear"]});
    let (status, model) = daemon.post("/api/v1/models", &fit.to_string());
    assert_eq!(status, 201, "{model}");
    let (mut socket, _) = tungstenite::connect(format!("ws://{}/api/v1/events", daemon.address())).unwrap();
    assert_eq!(daemon.post("/api/v1/runs", SHORT_RUN).0, 201);
    let (mut names, mut squares, mut left) = (Vec::new(), 0.0, 0.0);
    loop {
        match socket.read().unwrap() {
            Message::Text(text) => {
                let message: Value = serde_json::from_str(&text).unwrap();
                if message["type"] == "channels" {
                    let channels = message["channels"].as_array().unwrap();
                    names = channels.iter().map(|one| one["name"].as_str().unwrap().to_owned()).collect();
                }
                if message["type"] == "state" && !message["safe"].is_null() {
                    break;
                }
            }
            Message::Binary(frame) => {
                let values: Vec<f32> =
                    frame[24..].chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
                let rows = values.len() / names.len();
                let column = |name: &str| &values[names.iter().position(|one| one == name).unwrap() * rows..][..rows];
                for (measured, predicted) in column("motor_torque_nm").iter().zip(column("model_torque_nm")) {
                    squares += measured * measured;
                    left += (measured - predicted).powi(2);
                }
            }
            Message::Ping(_) => {}
            other => panic!("{other:?}"),
        }
    }
    let share = (left / squares).sqrt();
    assert!(share < 0.25, "the model leaves {share} of the torque");
}

#[test]
fn a_bench_tells_its_channels_before_and_after_a_run() {
    let daemon = TestDaemon::start();
    let channels = |bench: &Value| bench["channels"].as_array().unwrap().clone();
    let before = channels(&daemon.wait_for("/api/v1/bench/joint-a-mock", |bench| !channels(bench).is_empty()));
    assert!(before.iter().all(|one| one["unit"].is_string() && one["rate_hz"].is_null() && one["age_s"].is_null()));
    let run = daemon.post("/api/v1/runs", SHORT_RUN).1["id"].as_i64().unwrap();
    daemon.wait_for_end(run);
    let after = channels(&daemon.get("/api/v1/bench/joint-a-mock").1);
    for channel in before {
        let same = after.iter().find(|one| one["name"] == channel["name"]).unwrap();
        let age_s = same["age_s"].as_f64().unwrap();
        assert!(same["rate_hz"].as_f64().unwrap() > 1.0 && (0.0..60.0).contains(&age_s), "{same}");
    }
}
