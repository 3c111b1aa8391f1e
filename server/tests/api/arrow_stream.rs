//! Samples as an Arrow stream.

use crate::daemon::{SHORT_RUN, TestDaemon};
use arrow_array::RecordBatch;
use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use arrow_ipc::reader::StreamReader;
use serde_json::json;

const ARROW: &str = "application/vnd.apache.arrow.stream";

fn stream(daemon: &TestDaemon, path: &str, accept: &str) -> Vec<RecordBatch> {
    let mut response = daemon.get_raw_with(path, &[("accept", accept)]);
    assert_eq!(
        (response.status(), response.headers()["content-type"].to_str().unwrap()),
        (200.try_into().unwrap(), ARROW)
    );
    let bytes = response.body_mut().with_config().limit(1 << 30).read_to_vec().unwrap();
    StreamReader::try_new(bytes.as_slice(), None).unwrap().map(Result::unwrap).collect()
}

fn column(batches: &[RecordBatch], name: &str) -> Vec<f64> {
    let values =
        |batch: &RecordBatch| batch.column_by_name(name).unwrap().as_primitive::<Float64Type>().values().to_vec();
    batches.iter().flat_map(values).collect()
}

#[test]
fn an_arrow_stream_has_all_rows_of_the_window() {
    let daemon = TestDaemon::start();
    let (_, run) = daemon.post("/api/v1/runs", SHORT_RUN);
    let id = run["id"].as_i64().unwrap();
    let run = daemon.wait_for_end(id);
    let samples = format!("/api/v1/runs/{id}/samples");

    let whole = stream(&daemon, &samples, ARROW);
    let time = column(&whole, "time_s");
    assert_eq!(
        (json!(time.len()), json!(whole[0].num_columns())),
        (run["rows"].clone(), json!(run["channels"].as_array().unwrap().len()))
    );
    let schema = whole[0].schema();
    let facts: serde_json::Value = serde_json::from_str(schema.metadata().values().next().unwrap()).unwrap();
    assert_eq!(facts["kind"], "friction", "the metadata of the run: {facts}");

    let window = format!("{samples}?channels=motor_current_a,time_s&from_s=1&to_s=2");
    let part = stream(&daemon, &window, &format!("text/html, {ARROW};q=0.9"));
    let names: Vec<String> = part[0].schema().fields().iter().map(|field| field.name().clone()).collect();
    assert_eq!(names, ["motor_current_a", "time_s"]);
    let inside: Vec<f64> = time.into_iter().filter(|time_s| (1.0..=2.0).contains(time_s)).collect();
    assert_eq!(column(&part, "time_s"), inside);

    let refused = |path: &str| daemon.get_with(path, &[("accept", ARROW)]);
    let (status, problem) = refused(&format!("{samples}?channels=motor_current"));
    assert!(status == 404 || status == 422, "{problem}");
    let (status, problem) = refused(&format!("{samples}?px=100"));
    assert!(status == 400 && problem["detail"].as_str().unwrap().starts_with("px is for JSON"), "{problem}");
    assert_eq!(refused("/api/v1/runs/77/samples").0, 404);
    assert_eq!(daemon.get_with(&samples, &[("accept", "*/*")]).1["rows"], run["rows"], "JSON as before");
}
