//! What runs owe to the archive, and the removal of archived samples.

use super::super::{ArchiveEnd, BLOCK_ROWS, StoreError, verify};
use super::*;
use jiff::{SignedDuration, Timestamp};

/// A store whose runs owe both tables.
async fn archiving() -> (TempDir, Store) {
    let (folder, store) = fresh().await;
    store.set_archive_contents(&["means".to_owned(), "samples".to_owned()]).await.unwrap();
    (folder, store)
}

async fn completed(store: &Store, length: usize) -> RunId {
    let run = store.create_run(&new_run()).await.unwrap();
    commit(store, run, RunState::Running, rows(0, length / 2)).await;
    commit(store, run, RunState::Completed, rows(length / 2, length - length / 2)).await;
    run
}

fn archived(run: RunId) -> ArchiveEnd {
    ArchiveEnd::Archived {
        folder: "/srv/archive".into(),
        path: format!("samples/run-{run}.parquet"),
        bytes: 7,
        sha256: "ab".into(),
    }
}

async fn states(store: &Store, run: RunId) -> Vec<(String, String)> {
    let records = store.archive_of(run).await.unwrap();
    records.into_iter().map(|record| (record.content, record.state)).collect()
}

fn pairs(these: &[(&str, &str)]) -> Vec<(String, String)> {
    these.iter().map(|(content, state)| ((*content).to_owned(), (*state).to_owned())).collect()
}

#[test]
fn an_ended_run_owes_its_tables_and_an_import_none() {
    block_on(async {
        let (folder, store) = archiving().await;
        let run = store.create_run(&new_run()).await.unwrap();
        commit(&store, run, RunState::Running, rows(0, 10)).await;
        assert_eq!(states(&store, run).await, [], "it still runs");
        store.commit(run, RunState::Stopped, &[], Trace::default()).await.unwrap();
        assert_eq!(states(&store, run).await, pairs(&[("means", "owed"), ("samples", "owed")]));
        let import = NewRun { procedure: "import".into(), ..new_run() };
        let imported = store.import(&import, &[], rows(0, 3)).await.unwrap();
        assert_eq!(states(&store, imported).await, []);

        let reason = ArchiveEnd::Empty("no steady states".into());
        store.end_archive(run, "means", &reason).await.unwrap();
        let next = store.next_archive().await.unwrap().unwrap();
        assert_eq!((next.run, next.content.as_str()), (run, "samples"));
        store.retry_archive(run, "samples", Timestamp::now() + SignedDuration::from_mins(5), "away").await.unwrap();
        assert_eq!(store.next_archive().await.unwrap(), None, "not due");
        store.close().await;
        let store = Store::open(folder.path()).await.unwrap();
        let counts = store.archive_counts().await.unwrap();
        assert_eq!((counts.owed, counts.empty, counts.last_error.as_deref()), (1, 1, Some("away")));
        assert!(counts.oldest_owed.is_some());
        store.release_archive().await.unwrap();
        assert_eq!(store.next_archive().await.unwrap().unwrap().attempts, 0);

        store.end_archive(run, "samples", &ArchiveEnd::Failed("other data".into())).await.unwrap();
        assert_eq!(store.archive_counts().await.unwrap().failed, 1);
        store.release_archive().await.unwrap();
        assert_eq!(store.set_archive_contents(&[]).await.unwrap(), 1, "a debt of a removed archive");
        let run = completed(&store, 10).await;
        assert_eq!(states(&store, run).await, []);
    });
}

#[test]
fn only_archived_samples_can_be_removed() {
    block_on(async {
        let (folder, store) = archiving().await;
        let length = 2 * BLOCK_ROWS + 100;
        let run = completed(&store, length).await;
        let other = completed(&store, 50).await;
        let remove = || sqlx::query("DELETE FROM blocks WHERE run = ?").bind(run).execute(&store.writer);
        let refused = |done: Result<_, sqlx::Error>| done.unwrap_err().to_string().contains("samples never change");
        assert!(refused(remove().await));
        store.drop_samples(run, None).await.unwrap_err();
        store.end_archive(run, "samples", &archived(run)).await.unwrap();
        assert!(refused(remove().await), "archived, but not dropped");
        let window = store.window(run, None, None, None, 10).await.unwrap();

        let past = Timestamp::now() - SignedDuration::from_hours(1);
        assert_eq!(store.droppable_samples(past).await.unwrap(), []);
        let droppable = store.droppable_samples(Timestamp::now() + SignedDuration::from_secs(1)).await.unwrap();
        assert_eq!(droppable.iter().map(|one| one.run).collect::<Vec<_>>(), [run]);
        store.drop_samples(run, Some(b"{}")).await.unwrap();
        assert_eq!(store.result_of_dropped(run).await.unwrap().as_deref(), Some(&b"{}"[..]));
        let fault = store.trace(run, None, 0..10).await.unwrap_err();
        assert!(matches!(&fault, StoreError::Dropped { run: of, file } if *of == run && file.contains("/srv/archive")));
        assert_eq!(store.window(run, None, None, None, 10).await.unwrap(), window, "the overview is kept");
        assert_eq!(store.run(run).await.unwrap().rows, length as u64);
        assert_eq!(store.trace(other, None, 0..50).await.unwrap(), rows(0, 50));
        assert_eq!(store.droppable_samples(Timestamp::now()).await.unwrap(), []);
        assert_eq!(store.archive_counts().await.unwrap().dropped, 1);

        let report = verify(folder.path()).await.unwrap();
        assert!(report.is_whole(), "{report:?}");
        assert_eq!((report.runs, report.rows), (2, 50));
    });
}

#[test]
fn an_interrupted_removal_is_completed() {
    block_on(async {
        let (folder, store) = archiving().await;
        let run = completed(&store, 100).await;
        store.end_archive(run, "samples", &archived(run)).await.unwrap();
        let mark = "UPDATE archive SET dropped_at = '2026-01-01T00:00:00.000Z' WHERE run = ? AND content = 'samples'";
        sqlx::query(mark).bind(run).execute(&store.writer).await.unwrap();
        assert!(store.trace(run, None, 0..10).await.is_err());
        assert!(verify(folder.path()).await.unwrap().is_whole());
        store.complete_drops().await.unwrap();
        let left: i64 = sqlx::query_scalar("SELECT COUNT(*) FROM blocks").fetch_one(&store.readers).await.unwrap();
        assert_eq!(left, 0);
        let change = sqlx::query("UPDATE archive SET path = 'elsewhere'").execute(&store.writer).await;
        assert!(change.unwrap_err().to_string().contains("never changes"));
    });
}
