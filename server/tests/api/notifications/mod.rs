//! Notifications at real receivers on loopback ports.

mod receivers;

use crate::daemon::{BENCH, SHORT_RUN, TestDaemon};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use jointbench::config::{Notify, parse};
use receivers::{Hook, broker, mail_server, webhook};
use ring::hmac;
use serde_json::{Value, json};
use std::net::TcpListener;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The targets of a bench description.
fn targets(tables: &str) -> Notify {
    let bench = "[[bench]]\nname = \"a\"\nmock.joint = \"a\"\n";
    parse("bench.toml", &format!("{bench}{tables}")).unwrap().notify
}

fn daemon(tables: &str) -> TestDaemon {
    TestDaemon::start_with(None, |settings| settings.notify = targets(tables))
}

fn run(daemon: &TestDaemon) -> i64 {
    let mut new: Value = serde_json::from_str(SHORT_RUN).unwrap();
    new["unit"] = json!({"serial": "SN7"});
    let (status, run) = daemon.post("/api/v1/runs", &new.to_string());
    assert_eq!(status, 201, "{run}");
    let id = run["id"].as_i64().unwrap();
    assert_eq!(daemon.wait_for_end(id)["state"], "completed");
    id
}

fn stop(daemon: &TestDaemon) {
    assert_eq!(daemon.post(&format!("/api/v1/bench/{BENCH}/stop"), "").0, 200);
}

fn json_of(hook: &Hook) -> Value {
    serde_json::from_str(&hook.body).unwrap()
}

fn check_signature(hook: &Hook, key: &[u8]) {
    let [id, time, signature] =
        ["webhook-id", "webhook-timestamp", "webhook-signature"].map(|name| hook.header(name).unwrap());
    let signed = STANDARD.decode(signature.strip_prefix("v1,").unwrap()).unwrap();
    let content = format!("{id}.{time}.{}", hook.body);
    hmac::verify(&hmac::Key::new(hmac::HMAC_SHA256, key), content.as_bytes(), &signed).unwrap();
    let age_s = jiff::Timestamp::now().as_second() - time.parse::<i64>().unwrap();
    assert!((0..120).contains(&age_s), "{age_s}");
}

#[test]
fn a_webhook_gets_each_message_once_and_in_order_after_errors_and_a_restart() {
    let receiver = webhook(&[500, 500]);
    let folder = tempfile::tempdir().unwrap();
    let (file, key) = (folder.path().join("key"), b"sixteen bytes or more");
    std::fs::write(&file, format!("whsec_{}", STANDARD.encode(key))).unwrap();
    let tables = format!(
        "[[notify]]\nevents = [\"finished\"]\nwebhook = \"http://{}/hidden/path\"\nsecret_file = \"{}\"\n",
        receiver.address,
        file.display()
    );
    let mut daemon = daemon(&tables);
    let first = run(&daemon);
    receiver.wait_for(1);
    daemon.restart_with(None, |settings| settings.notify = targets(&tables));
    let second = run(&daemon);

    let hooks = receiver.wait_for(4);
    let messages: Vec<Value> = hooks.iter().map(json_of).collect();
    let runs: Vec<&Value> = messages.iter().map(|message| &message["run"]).collect();
    assert_eq!(runs, [first, first, first, second], "each one until its first 200, then the next one");
    assert!(hooks[..3].iter().all(|hook| hook.body == hooks[0].body), "{hooks:?}");
    assert_ne!(messages[0]["id"], messages[3]["id"]);
    for (hook, message) in hooks.iter().zip(&messages) {
        check_signature(hook, key);
        assert_eq!(hook.header("webhook-id"), message["id"].as_str());
    }
    let last = &messages[3];
    for (field, expected) in
        [("event", "finished"), ("bench", BENCH), ("procedure", "friction"), ("unit", "SN7"), ("state", "completed")]
    {
        assert_eq!(last[field], expected, "{last}");
    }
    assert!(last["verdict"].is_string() && last["summary"].as_str().unwrap().starts_with("run 2 completed"), "{last}");
    assert_eq!(last["link"], format!("http://{}/runs/{second}", daemon.address()));

    let listed = daemon.wait_for("/api/v1/notifications", |targets| targets[0]["pending"] == 0);
    let target = &listed[0];
    assert_eq!(
        (&target["kind"], &target["failed"], &target["last_error"]),
        (&json!("webhook"), &json!(0), &Value::Null)
    );
    assert!(target["last_delivery"].is_string(), "{target}");
    for secret in ["hidden", "whsec", &STANDARD.encode(key)] {
        assert!(!listed.to_string().contains(secret), "{secret}: {listed}");
    }
    assert_eq!(receiver.received().len(), 4);
}

#[test]
fn a_silent_target_delays_neither_a_run_nor_another_target() {
    let silent = TcpListener::bind("127.0.0.1:0").unwrap();
    let receiver = webhook(&[]);
    let hook = |name: &str, address| format!("[[notify]]\nname = \"{name}\"\nwebhook = \"http://{address}/\"\n");
    let tables = hook("silent", silent.local_addr().unwrap()) + &hook("other", receiver.address);
    let daemon = daemon(&tables);
    run(&daemon);
    receiver.wait_for(1);
    let began = Instant::now();
    run(&daemon);
    let took = began.elapsed();
    stop(&daemon);
    let messages: Vec<Value> = receiver.wait_for(3).iter().map(json_of).collect();
    let mut events: Vec<&str> = messages.iter().map(|message| message["event"].as_str().unwrap()).collect();
    events.sort_unstable();
    assert_eq!(events, ["finished", "finished", "needs_hand"]);
    let stopped = messages.iter().find(|message| message["event"] == "needs_hand").unwrap();
    assert_eq!(stopped["summary"], format!("bench {BENCH}: software stop pressed"));
    assert!(took < Duration::from_secs(20), "the run took {took:?}");

    let failed = |targets: &Value| targets[0]["last_error"].is_string();
    let targets = daemon.wait_for("/api/v1/notifications", failed);
    assert_eq!((&targets[0]["pending"], &targets[1]["pending"]), (&json!(3), &json!(0)), "{targets}");
    let text = daemon.get_raw("/metrics").body_mut().read_to_string().unwrap();
    assert!(text.contains("jointbench_notifications_pending{target=\"silent\"} 3.0"), "{text}");
    let (status, tests) = daemon.post("/api/v1/notifications/test", "");
    assert_eq!((status, &tests[1]["error"]), (200, &Value::Null), "{tests}");
    assert!(tests[0]["error"].is_string(), "{tests}");
    assert_eq!(json_of(&receiver.wait_for(4)[3])["event"], "test");
}

#[test]
fn a_mail_has_the_facts_as_text() {
    let server = mail_server();
    let daemon = daemon(&format!(
        "[[notify]]\nmail = \"Ada <ada@example.org>\"\nfrom = \"bench@example.org\"\nsmtp = \"smtp://{}\"\n",
        server.address
    ));
    run(&daemon);
    stop(&daemon);
    let mails = server.wait_for(2);
    let [finished, stopped] = ["run 1 finished", "needs a person"].map(|words| {
        let subject = |mail: &&String| mail.lines().any(|line| line.starts_with("Subject: ") && line.contains(words));
        mails.iter().find(subject).unwrap_or_else(|| panic!("{words} in {mails:?}"))
    });
    for line in [
        "From: bench@example.org",
        "Event: finished",
        "Procedure: friction",
        "Unit under test: SN7",
        "State: completed",
    ] {
        assert!(finished.lines().any(|there| there.trim_end() == line), "{line} in {finished}");
    }
    assert!(finished.contains("To: Ada <ada@example.org>") && finished.contains("@jointbench>"), "{finished}");
    assert!(stopped.contains(&format!("bench {BENCH}: software stop pressed.")), "{stopped}");
}

const TOPIC: &str = "lab/bench";

fn mqtt(port: u16) -> TestDaemon {
    daemon(&format!("[[notify]]\nmqtt = \"mqtt://127.0.0.1:{port}\"\ntopic = \"{TOPIC}\"\n"))
}

#[test]
fn a_broker_gets_json_on_the_topic() {
    let broker = broker();
    let daemon = mqtt(broker.address.port());
    stop(&daemon);
    let (topic, payload) = broker.wait_for(1).remove(0);
    let message: Value = serde_json::from_str(&payload).unwrap();
    assert_eq!((topic.as_str(), &message["event"], &message["bench"]), (TOPIC, &json!("needs_hand"), &json!(BENCH)));
    daemon.wait_for("/api/v1/notifications", |targets| targets[0]["pending"] == 0);
    assert_eq!(broker.received().len(), 1);
}

/// The same with mosquitto and its client.
#[test]
fn mosquitto_gets_json_on_the_topic() {
    let there =
        |program| Command::new(program).arg("--help").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
    if !(there("mosquitto") && there("mosquitto_sub")) {
        eprintln!("SKIPPED: mosquitto is not installed");
        return;
    }
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port().to_string();
    let quiet = |program: &str, arguments: &[&str]| {
        Command::new(program)
            .args(["-p", &port])
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    };
    let mut broker = quiet("mosquitto", &[]);
    let began = Instant::now();
    while std::net::TcpStream::connect(format!("127.0.0.1:{port}")).is_err()
        && began.elapsed() < Duration::from_secs(10)
    {
        std::thread::sleep(Duration::from_millis(20));
    }
    let subscriber = quiet("mosquitto_sub", &["-t", TOPIC, "-q", "1", "-C", "1", "-W", "60"]);
    let daemon = mqtt(port.parse().unwrap());
    stop(&daemon);
    let heard = subscriber.wait_with_output().unwrap();
    let _ = broker.kill();
    let _ = broker.wait();
    let message: Value = serde_json::from_slice(&heard.stdout).unwrap();
    assert_eq!((&message["event"], &message["bench"]), (&json!("needs_hand"), &json!(BENCH)));
}
