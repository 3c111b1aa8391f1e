//! Tests of the complete check and of backups.

use super::super::values::now;
use super::super::{StoreError, VerifyReport, backup, restore, verify};
use super::damage::damage;
use super::*;
use serde_json::json;
use std::time::Duration;

/// A store with two runs, one of them active, and related records.
async fn furnished() -> (TempDir, Store) {
    let (folder, store) = fresh().await;
    store.import(&new_run_of_unit("SN1"), &[note(0.0, "from a file")], rows(0, 70_000)).await.unwrap();
    let run = store.create_run(&new_run()).await.unwrap();
    store.commit(run, RunState::Running, &[note(0.0, "armed")], rows(0, 40_000)).await.unwrap();
    let model = store.save_model(&super::damage::model(1)).await.unwrap();
    store.save_diagnosis(model.id, &json!({"verdict": "adequate"})).await.unwrap();
    store.save_note(1, Some(1.5), "smells of ozone").await.unwrap();
    store.block_bench("joint-a", Some(run), "cover open").await.unwrap();
    store.calibrate("joint-a", "brake", Some(1), "Anna").await.unwrap();
    store.keep_fault("joint-a", "drive", "2026-01-31T00:00:00Z", "unplugged").await.unwrap();
    store.save_user_effect("friction", "rub", &json!({"formula": "tau = a"})).await.unwrap();
    store.use_effect(1, "friction", "rub", true, "Anna").await.unwrap();
    store.set_unit_reference("SN1", true, "Anna").await.unwrap();
    let autopilot = store.create_autopilot("joint-a", &Default::default(), "running").await.unwrap();
    store.append_autopilot_step(autopilot, json!({"what": "measured"})).await.unwrap();
    (folder, store)
}

fn tables(report: &VerifyReport) -> Vec<(Option<i64>, &str)> {
    report.damaged.iter().map(|finding| (finding.run, finding.table.as_str())).collect()
}

#[test]
fn a_store_in_use_is_whole() {
    block_on(async {
        let (folder, store) = furnished().await;
        let report = verify(folder.path()).await.unwrap();
        assert!(report.is_whole(), "{report:?}");
        assert_eq!((report.runs, report.rows, report.without_checksum), (2, 110_000, 0));
        // 3 blocks and 1 with 3 channels, a tail piece, 2 runs twice, 6 channels, 2 events, and 11 single records.
        assert_eq!(report.records, 4 * 3 + 1 + 4 + 6 + 2 + 11);
        assert!(store.check(Duration::ZERO).await.unwrap().is_whole());
        let nothing = verify(&folder.path().join("elsewhere")).await.unwrap_err();
        assert!(matches!(nothing, StoreError::NoStore { .. }) && nothing.is_setup(), "{nothing}");
    });
}

#[test]
fn an_earlier_schema_lacks_later_tables_and_is_whole() {
    block_on(async {
        let (folder, store) = furnished().await;
        let change = async |sql: &'static str| sqlx::query(sql).execute(&store.writer).await.unwrap();
        change("DROP TABLE unit_references").await;
        assert!(!verify(folder.path()).await.unwrap().is_whole(), "a table of this schema is missing");
        change("DELETE FROM _sqlx_migrations WHERE description = 'unit references'").await;
        let report = verify(folder.path()).await.unwrap();
        assert!(report.is_whole(), "{report:?}");
    });
}

#[test]
fn every_kind_of_damage_is_found_where_it_is() {
    block_on(async {
        let cases: [(&'static str, Option<i64>, &str); 20] = [
            ("UPDATE runs SET meta = '{}' WHERE id = 1", Some(1), "runs"),
            ("UPDATE runs SET reason = 'another' WHERE id = 2", Some(2), "runs"),
            ("UPDATE runs SET rows = 9, state_checksum = NULL WHERE id = 2", Some(2), "runs"),
            ("UPDATE run_units SET serial = 'SN2'", Some(1), "run_units"),
            ("UPDATE events SET at_s = 7.0 WHERE run = 2", Some(2), "events"),
            ("UPDATE channels SET resolution = 1.0 WHERE run = 1 AND place = 1", Some(1), "channels"),
            ("UPDATE blocks SET data = x'00' WHERE run = 1 AND channel = 0 AND first_row = 32768", Some(1), "blocks"),
            ("DELETE FROM blocks WHERE run = 1 AND channel = 2 AND first_row = 0", Some(1), "blocks"),
            ("DELETE FROM spans WHERE run = 1 AND first_row = 32768", Some(1), "spans"),
            ("UPDATE spans SET coarse = x'', coarse_checksum = NULL WHERE run = 1", Some(1), "spans"),
            ("UPDATE tail SET data = x'00', checksum = NULL WHERE run = 2", Some(2), "tail"),
            ("UPDATE models SET rms = 7.0", Some(1), "models"),
            ("UPDATE diagnoses SET diagnosis = '{}'", Some(1), "diagnoses"),
            ("UPDATE notes SET text = 'all fine'", Some(1), "notes"),
            ("UPDATE bench_safety SET blocked = 0", None, "bench_safety"),
            ("UPDATE calibrations SET run = 2", None, "calibrations"),
            ("UPDATE own_effects SET definition = '{}'", None, "own_effects"),
            ("UPDATE effect_uses SET used = 0", Some(1), "effect_uses"),
            ("UPDATE unit_references SET is_reference = 0", None, "unit_references"),
            ("UPDATE autopilot_steps SET step = '{}'", None, "autopilot_steps"),
        ];
        for (sql, run, table) in cases {
            let (folder, store) = furnished().await;
            damage(&store, sql).await;
            let report = verify(folder.path()).await.unwrap();
            assert!(tables(&report).contains(&(run, table)), "{sql}: {report:?}");
            let elsewhere = tables(&report).into_iter().find(|(other, _)| other.is_some() && *other != run);
            assert_eq!(elsewhere, None, "{sql}: {report:?}");
        }
    });
}

#[test]
fn rows_of_an_older_release_get_their_checksums() {
    block_on(async {
        let (folder, store) = furnished().await;
        for sealed in super::super::seal::ALL {
            damage(&store, &format!("UPDATE {} SET {} = NULL", sealed.table, sealed.checksum)).await;
        }
        check_rows(&store, 1, 70_000).await;
        let old = store.check(Duration::ZERO).await.unwrap();
        assert!(old.is_whole() && old.without_checksum > 30, "{old:?}");
        let sealed = verify(folder.path()).await.unwrap();
        assert!(sealed.is_whole() && sealed.without_checksum == 0, "{sealed:?}");
    });
}

#[test]
fn a_backup_of_a_store_in_use_comes_back_whole() {
    block_on(async {
        let (folder, store) = furnished().await;
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("lab.db");
        assert!(backup(folder.path(), &file).await.unwrap().is_whole());
        assert!(matches!(backup(folder.path(), &file).await.unwrap_err(), StoreError::Copy { .. }), "never replaced");
        commit(&store, 2, RunState::Running, rows(40_000, 10)).await;

        let refused = restore(folder.path(), &file).await.unwrap_err();
        assert!(matches!(refused, StoreError::InUse { .. }), "{refused}");
        let other = place.path().join("other");
        assert_eq!(restore(&other, &file).await.unwrap(), None);
        check_rows(&Store::open(&other).await.unwrap(), 2, 40_000).await;

        store.acknowledge_bench("joint-a", &now(), "looked", "Anna").await.unwrap();
        store.close().await;
        drop(store);
        let aside = restore(folder.path(), &file).await.unwrap().expect("what was there is kept");
        assert!(aside.join("jointbench.db").is_file());
        let back = Store::open(folder.path()).await.unwrap();
        check_rows(&back, 2, 40_000).await;
        assert_eq!(back.losses().await.unwrap().len(), 1, "the folder has held more");
        assert!(back.bench_block("joint-a").await.unwrap().unwrap().reason.contains("missing"));
        assert!(verify(folder.path()).await.unwrap().is_whole());
    });
}
