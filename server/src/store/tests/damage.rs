//! Damage in the file: each damaged record is named, and does not hide others.

use super::super::{NewModel, RunFilter, Search, StoreError};
use super::*;
use serde_json::{Map, json};
use sqlx::AssertSqlSafe;

/// Changes stored data without triggers and constraints, like a failing disk.
pub async fn damage(store: &Store, sql: &str) {
    let triggers: Vec<(String, String)> = sqlx::query_as("SELECT name, sql FROM sqlite_schema WHERE type = 'trigger'")
        .fetch_all(&store.writer)
        .await
        .unwrap();
    let mut writer = store.writer.acquire().await.unwrap();
    let drop_all = triggers.iter().map(|(name, _)| format!("DROP TRIGGER {name}"));
    let check_nothing = "PRAGMA ignore_check_constraints = 1".to_owned();
    for prepare in drop_all.chain([check_nothing]) {
        sqlx::query(AssertSqlSafe(prepare)).execute(&mut *writer).await.unwrap();
    }
    let hit = sqlx::query(AssertSqlSafe(sql.to_owned())).execute(&mut *writer).await.unwrap().rows_affected();
    assert!(hit > 0, "{sql}");
    for (_, again) in triggers {
        sqlx::query(AssertSqlSafe(again)).execute(&mut *writer).await.unwrap();
    }
}

fn check_names(fault: StoreError, names: &[&str]) {
    assert!(matches!(fault, StoreError::Damaged(_)), "{fault}");
    for name in names.iter().chain(&["jointbench verify", "backup"]) {
        assert!(fault.to_string().contains(name), "{name}: {fault}");
    }
}

pub fn model(run: RunId) -> NewModel {
    NewModel {
        run,
        more_runs: Vec::new(),
        excluded: json!([]),
        parent: None,
        kind: "friction".into(),
        effects: vec!["coulomb".into()],
        fit: json!({"unit": "Nm", "parameters": []}),
        residual: "raw".into(),
        rms: 0.5,
        validation_rms: -0.0,
        noise_floor_rms: Some(f64::NAN),
        options: Map::new(),
        tried: false,
        by: "Anna".into(),
    }
}

#[test]
fn a_bit_in_the_samples_is_noticed_and_named() {
    block_on(async {
        for (sql, names) in [
            (
                "UPDATE blocks SET data = CAST(data || x'00' AS BLOB) WHERE run = 1 AND channel = 1 AND first_row = 0",
                vec!["table blocks", "run 1", "channel 1", "first_row 0"],
            ),
            (
                "UPDATE blocks SET first_row = 7 WHERE run = 1 AND channel = 0 AND first_row = 0",
                vec!["table blocks", "run 1"],
            ),
            (
                "UPDATE tail SET data = CAST(x'00' || data AS BLOB) WHERE run = 1",
                vec!["table tail", "run 1", "first_row 32768"],
            ),
            (
                "UPDATE channels SET name = 'torque' WHERE run = 1 AND place = 2",
                vec!["table channels", "run 1", "place 2"],
            ),
        ] {
            let (_folder, store) = fresh().await;
            for _ in 0..2 {
                let run = store.create_run(&new_run()).await.unwrap();
                commit(&store, run, RunState::Running, rows(0, 40_000)).await;
            }
            damage(&store, sql).await;
            check_names(store.trace(1, None, 0..u64::MAX).await.unwrap_err(), &names);
            check_rows(&store, 2, 40_000).await;
        }
    });
}

#[test]
fn a_bit_in_the_pyramid_is_noticed_and_named() {
    block_on(async {
        for (sql, px) in [
            ("UPDATE spans SET coarse = CAST(coarse || x'00' AS BLOB)", 10),
            ("UPDATE spans SET fine = CAST(fine || x'00' AS BLOB)", 500),
            ("UPDATE spans SET to_s = to_s + 1", 10),
        ] {
            let (_folder, store) = fresh().await;
            let run = store.create_run(&new_run()).await.unwrap();
            commit(&store, run, RunState::Running, rows(0, 70_000)).await;
            damage(&store, sql).await;
            let fault = store.window(run, None, Some(0.0), None, px).await.unwrap_err();
            check_names(fault, &["table spans", "run 1", "first_row"]);
            assert_eq!(store.trace(run, None, 0..u64::MAX).await.unwrap(), rows(0, 70_000), "samples are whole");
        }
    });
}

#[test]
fn a_damaged_run_is_listed_and_hides_no_other() {
    block_on(async {
        for sql in [
            "UPDATE runs SET provenance = '{\"seed\": 7' WHERE id = 2",
            "UPDATE runs SET meta = '{}' WHERE id = 2",
            "UPDATE runs SET parameters = CAST(x'7b22ff227d' AS TEXT) WHERE id = 2",
            "UPDATE runs SET state = 'compleved' WHERE id = 2",
            "UPDATE runs SET rows = 499 WHERE id = 2",
            "UPDATE runs SET reason = 'another' WHERE id = 2",
        ] {
            let (_folder, store) = fresh().await;
            for _ in 0..3 {
                store.import(&new_run(), &[], rows(0, 500)).await.unwrap();
            }
            damage(&store, sql).await;
            let filter = RunFilter { limit: 10, ..RunFilter::default() };
            let (total, runs) = store.runs(&filter).await.unwrap();
            let listed: Vec<_> = runs.iter().map(|run| (run.id, run.damaged.is_some(), run.bench.as_str())).collect();
            assert_eq!(
                (total, listed),
                (3, vec![(3, false, "joint-a"), (2, true, "joint-a"), (1, false, "joint-a")]),
                "{sql}"
            );
            check_names(store.run(2).await.unwrap_err(), &["table runs", "id 2"]);
            store.run(1).await.unwrap();
            assert_eq!(store.continued_by(1).await.unwrap(), None);

            let search = RunFilter { search: Some("bench:joint-a".into()), limit: 2, ..RunFilter::default() };
            let parsed = Search::parse("bench:joint-a").unwrap();
            let (total, list_individually) = store.list_individually(&parsed, &search).await.unwrap();
            assert_eq!(
                (total, &list_individually[..]),
                (3, &runs[..2]),
                "as where SQLite cannot read through the table"
            );
        }
    });
}

#[test]
fn damaged_models_diagnoses_notes_and_events_hide_no_others() {
    block_on(async {
        let (_folder, store) = fresh().await;
        let run = store.create_run(&new_run()).await.unwrap();
        store.commit(run, RunState::Completed, &[note(0.0, "a"), note(1.0, "b")], Trace::default()).await.unwrap();
        for text in ["one", "two"] {
            store.save_note(run, Some(-0.0), text).await.unwrap();
            store.save_diagnosis(store.save_model(&model(run)).await.unwrap().id, &json!({})).await.unwrap();
            store.save_diagnosis(1, &json!({"verdict": text})).await.unwrap();
        }
        damage(&store, "UPDATE models SET fit = '{\"parameters\"' WHERE id = 2").await;
        damage(&store, "UPDATE diagnoses SET diagnosis = '{\"verdict\": \"two!\"}' WHERE id = 2").await;
        damage(&store, "UPDATE notes SET text = 'ome' WHERE id = 1").await;
        damage(&store, "UPDATE events SET data = '{\"text\": \"c\"}' WHERE sequence = 1").await;

        assert_eq!(store.models(run).await.unwrap().iter().map(|model| model.id).collect::<Vec<_>>(), [1]);
        assert_eq!(store.versions(run).await.unwrap().len(), 1);
        check_names(store.model(2).await.unwrap_err(), &["table models", "run 1", "id 2"]);
        assert_eq!(store.diagnoses(1).await.unwrap().iter().map(|one| one.id).collect::<Vec<_>>(), [1, 4]);
        let notes = store.notes(run).await.unwrap();
        assert!(notes[0].text.contains("table notes, run 1, id 1") && notes[1].text == "two", "{notes:?}");
        let events = store.events(run, 0).await.unwrap();
        assert_eq!((events[0].kind.as_str(), events[1].kind.as_str()), ("damaged", "note"));
        assert_eq!(store.run(run).await.unwrap().model.unwrap()["id"], 1, "the last that can be read");
        let by_friction =
            RunFilter { limit: 9, order: super::super::Order::parse("coulomb").unwrap(), ..RunFilter::default() };
        assert_eq!(store.runs(&by_friction).await.unwrap().0, 1);
    });
}

#[test]
fn a_damaged_safety_entry_blocks_the_bench_until_a_person_has_looked() {
    block_on(async {
        let (_folder, store) = fresh().await;
        store.block_bench("joint-a", None, "cover open").await.unwrap();
        store.calibrate("joint-a", "brake", None, "Anna").await.unwrap();
        damage(&store, "UPDATE bench_safety SET blocked = 0").await;
        let block = store.bench_block("joint-a").await.unwrap().expect("nobody knows whether it was released");
        assert!(block.reason.contains("table bench_safety, bench joint-a"), "{}", block.reason);
        assert_eq!(store.bench_block("joint-a").await.unwrap(), Some(block), "reported once");
        assert_eq!(store.safety("joint-a", 9).await.unwrap().len(), 2);
        damage(&store, "UPDATE calibrations SET procedure = 'broke'").await;
        check_names(store.calibration("joint-a", "broke").await.unwrap_err(), &["table calibrations", "bench joint-a"]);
    });
}

#[test]
fn a_run_with_damaged_rows_does_not_keep_the_daemon_from_starting() {
    block_on(async {
        let (_folder, store) = fresh().await;
        let run = store.create_run(&new_run()).await.unwrap();
        commit(&store, run, RunState::Running, rows(0, 40_000)).await;
        damage(&store, "UPDATE tail SET data = x'00'").await;
        let interrupted = store.interrupt_open_runs().await.unwrap();
        assert_eq!((interrupted[0].id, interrupted[0].state), (run, RunState::Interrupted));
        assert_eq!(store.interrupt_open_runs().await.unwrap(), []);
        assert_eq!(store.trace(run, None, 0..32_768).await.unwrap(), rows(0, 32_768));
    });
}
