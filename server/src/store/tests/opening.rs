use super::super::StoreError;
use super::*;
use std::fs;

async fn refusal(folder: &std::path::Path) -> StoreError {
    let refused = Store::open(folder).await.unwrap_err();
    assert!(refused.is_setup(), "{refused}");
    assert!(refused.to_string().contains("choose another"), "says what to do next: {refused}");
    refused
}

#[test]
fn a_store_is_opened_again_where_it_was_left() {
    block_on(async {
        let (folder, store) = fresh().await;
        let run = store.create_run(&new_run()).await.unwrap();
        commit(&store, run, RunState::Running, rows(0, 100)).await;
        for (pragma, expected) in [("PRAGMA journal_mode", "wal"), ("PRAGMA synchronous", "2")] {
            let value: String = match pragma {
                "PRAGMA journal_mode" => sqlx::query_scalar(pragma).fetch_one(&store.writer).await.unwrap(),
                _ => sqlx::query_scalar::<_, i64>(pragma).fetch_one(&store.writer).await.unwrap().to_string(),
            };
            assert_eq!(value, expected, "{pragma}");
        }
        store.close().await;
        drop(store);
        check_rows(&Store::open(folder.path()).await.unwrap(), run, 100).await;
    });
}

#[test]
fn one_daemon_for_each_data_folder() {
    block_on(async {
        let (folder, store) = fresh().await;
        let second = refusal(folder.path()).await;
        assert!(matches!(second, StoreError::InUse { .. }), "{second}");
        assert!(second.to_string().contains(&format!("(process {})", std::process::id())), "{second}");
        let clone = store.clone();
        drop(store);
        refusal(folder.path()).await;
        clone.close().await;
        Store::open(folder.path()).await.unwrap();
    });
}

#[test]
fn what_is_not_ours_is_not_touched() {
    block_on(async {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("jointbench.db");
        fs::write(&file, "not a database, but somebody's notes, which are longer than a header").unwrap();
        assert!(matches!(refusal(folder.path()).await, StoreError::Foreign { .. }));
        assert!(fs::read_to_string(&file).unwrap().starts_with("not a database"));

        fs::remove_file(&file).unwrap();
        let foreign = sqlx::SqlitePool::connect(&format!("sqlite://{}?mode=rwc", file.display())).await.unwrap();
        sqlx::query("CREATE TABLE recipes (name TEXT)").execute(&foreign).await.unwrap();
        foreign.close().await;
        let before = fs::read(&file).unwrap();
        assert!(matches!(refusal(folder.path()).await, StoreError::Foreign { .. }));
        assert_eq!(fs::read(&file).unwrap(), before);

        let in_the_way = folder.path().join("jointbench.db").join("data");
        assert!(matches!(refusal(&in_the_way).await, StoreError::Unwritable { .. }));
    });
}

#[test]
fn other_versions_are_named() {
    block_on(async {
        for (sql, newer) in [
            (
                "UPDATE _sqlx_migrations SET version = 9999 WHERE version = (SELECT MAX(version) FROM _sqlx_migrations)",
                true,
            ),
            ("UPDATE _sqlx_migrations SET checksum = x'00'", false),
        ] {
            let (folder, store) = fresh().await;
            sqlx::query(sql).execute(&store.writer).await.unwrap();
            store.close().await;
            drop(store);
            let refused = refusal(folder.path()).await;
            assert_eq!(matches!(refused, StoreError::Newer { schema: 9999, .. }), newer, "{refused}");
            assert_eq!(matches!(refused, StoreError::Old { .. }), !newer, "{refused}");
        }
    });
}
