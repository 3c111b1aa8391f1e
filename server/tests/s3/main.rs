//! The archive in object storage: a daemon with moto (`pip install 'moto[server]'`), which answers as S3 does.

mod programs;

use programs::{Moto, Service};
use serde_json::{Value, json};
use std::net::TcpListener;
use std::time::{Duration, Instant};

const FILES: &str = "s3://joints/lab-1/";

#[test]
fn runs_are_archived_in_a_bucket_as_soon_as_it_answers() {
    // This port takes connections and never answers.
    let silent = TcpListener::bind("127.0.0.1:0").unwrap();
    let endpoint = silent.local_addr().unwrap();
    let mut daemon =
        Service::start(&format!("[archive]\nurl = \"{}\"\nraw = true\n", FILES.trim_end_matches('/')), endpoint);
    let began = Instant::now();
    let first = daemon.run();
    let took = began.elapsed();
    assert!(took < Duration::from_secs(30), "the run took {took:?}");
    let state = daemon.wait_for("archive", |archive| archive["last_error"].is_string());
    assert_eq!((&state["owed"], &state["archived"]), (&json!(2), &json!(0)), "{state}");

    drop(silent);
    let moto = Moto::start(endpoint);
    daemon.retry();
    let states =
        |why: &'static str| move |archive: &Value| archive["last_error"].as_str().is_some_and(|e| e.contains(why));
    daemon.wait_for("archive", states("bucket does not exist"));
    moto.put("joints", "");
    daemon.retry();
    let state = daemon.wait_for("archive", |archive| archive["owed"] == 0);
    assert_eq!((&state["archived"], &state["failed"], &state["last_error"]), (&json!(2), &json!(0), &Value::Null));

    let list = String::from_utf8(moto.get("joints")).unwrap();
    assert_eq!(list.matches("<Key>").count(), 2, "no incomplete file: {list}");
    let samples = daemon.table(first, "samples");
    let archived = moto.get(&object(&samples));
    assert_eq!(samples["bytes"], archived.len());
    let exported = daemon.get_bytes(&format!("runs/{first}/export?format=parquet"));
    let [archived, exported] = [archived, exported]
        .map(|bytes| jointbench_files::read_bytes("x.parquet", &bytes, &Default::default()).unwrap());
    assert_eq!(archived.trace(), exported.trace());

    not_replaced(&daemon, &moto, first);
    let log = daemon.stop();
    assert!(log.contains("not archived, it is repeated") && !log.contains(programs::KEY), "{log}");
}

/// Objects with other data are not replaced, and samples are compared before they are removed.
fn not_replaced(daemon: &Service, moto: &Moto, first: i64) {
    let second = first + 1;
    let taken =
        object(&daemon.table(first, "means")).replace(&format!("-{first}.parquet"), &format!("-{second}.parquet"));
    moto.put(&taken, "other data");
    assert_eq!(daemon.run(), second);
    let state = daemon.wait_for("archive", |archive| archive["owed"] == 0);
    assert_eq!((&state["archived"], &state["failed"]), (&json!(3), &json!(1)), "{state}");
    assert!(state["last_error"].as_str().unwrap().contains("cannot be read"), "{state}");
    assert_eq!(moto.get(&taken), b"other data");

    let file = object(&daemon.table(second, "samples"));
    moto.put(&file, "damaged");
    assert_eq!(daemon.delete(&format!("runs/{second}/samples")), 409);
    assert_eq!(daemon.delete(&format!("runs/{first}/samples")), 200);
    assert!(daemon.table(first, "samples")["dropped_at"].is_string());
}

/// Bucket and key of an archived table.
fn object(table: &Value) -> String {
    let file = table["file"].as_str().unwrap_or_else(|| panic!("{table}"));
    assert!(file.starts_with(FILES), "{file}");
    file.trim_start_matches("s3://").replace('%', "%25")
}
