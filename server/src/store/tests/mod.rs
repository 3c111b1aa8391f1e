//! Tests of the store in a temporary folder.

mod archiving;
mod crash;
mod damage;
mod keeping;
mod losing;
mod notifying;
mod opening;
mod sorting;
mod verifying;
mod viewing;

use super::{NewRun, Store, Unit};
use jointbench_instrument::{Channel, Trace};
use jointbench_procedure::{Event, EventKind, RunId, RunState};
use std::future::Future;
use std::path::Path;
use std::time::Duration;
use tempfile::TempDir;

fn block_on<T>(work: impl Future<Output = T>) -> T {
    tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build().unwrap().block_on(work)
}

/// A new store after its first checkpoint: its later changes are only in the write-ahead log until a run ends.
async fn fresh() -> (TempDir, Store) {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).await.unwrap();
    wait_for_checkpoint(folder.path()).await;
    (folder, store)
}

async fn wait_for_checkpoint(folder: &Path) {
    let length = || std::fs::metadata(folder.join("jointbench.db-wal")).unwrap().len();
    for _ in 0..2_000 {
        if length() == 0 {
            return;
        }
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    panic!("no checkpoint within 10 s");
}

fn new_run() -> NewRun {
    let object = |text: &str| serde_json::from_str(text).unwrap();
    NewRun {
        bench: "joint-a".into(),
        procedure: "friction".into(),
        kind: "friction".into(),
        simulated: true,
        parameters: object(r#"{"speeds": 12, "dwell_s": 0.30000000000000004}"#),
        provenance: object(r#"{"seed": 7, "software": "0.1.0"}"#),
        meta: object(r#"{"kind": "friction", "gear_ratio": 50.0}"#),
        ..NewRun::default()
    }
}

fn new_run_of_unit(serial: &str) -> NewRun {
    let part = Some("P".to_owned());
    let unit = Unit { serial: serial.into(), part, revision: None, batch: Some("7".into()) };
    NewRun { unit: Some(unit), operator: Some("A. Smith".into()), ..new_run() }
}

/// Rows of a run from `first` on: time, encoder, and noise without a step.
fn rows(first: usize, count: usize) -> Trace {
    let channels = vec![
        Channel::new("time_s"),
        Channel::counted("motor_position_rad", std::f64::consts::TAU / 16_384.0),
        Channel::new("link_torque_nm"),
    ];
    let mut trace = Trace::new(channels);
    for row in first..first + count {
        let angle = (row as f64 * 0.01).sin() * 1000.0;
        trace.push_row(&[
            row as f64 * 0.004,
            angle.round() * (std::f64::consts::TAU / 16_384.0),
            (row as f64).sqrt().sin(),
        ]);
    }
    trace
}

fn note(at_s: f64, text: &str) -> Event {
    Event { at_s, kind: EventKind::Note { text: text.into() } }
}

async fn commit(store: &Store, run: RunId, state: RunState, rows: Trace) {
    store.commit(run, state, &[], rows).await.unwrap();
}

async fn check_rows(store: &Store, run: RunId, count: usize) {
    assert_eq!(store.run(run).await.unwrap().rows, count as u64);
    assert_eq!(store.trace(run, None, 0..u64::MAX).await.unwrap(), rows(0, count));
}
