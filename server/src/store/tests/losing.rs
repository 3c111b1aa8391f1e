//! A removed or truncated write-ahead log, and its detection by the mark.

use super::super::mark::Mark;
use super::super::values::now;
use super::super::{Loss, StoreError, verify};
use super::*;
use std::fs;

/// A copy of the files on the disk after the mark has reached the last change.
async fn copy_when_marked(folder: &Path, store: &Store) -> TempDir {
    let changes: i64 = sqlx::query_scalar("SELECT changes FROM store_log").fetch_one(&store.readers).await.unwrap();
    let is_marked = || Mark::read(folder).is_some_and(|mark| mark.changes == changes);
    for _ in 0..2_000 {
        if is_marked() {
            break;
        }
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    assert!(is_marked(), "the keeper marks the last change");
    let copy = tempfile::tempdir().unwrap();
    for file in ["jointbench.db", "jointbench.db-wal", "jointbench.mark"] {
        fs::copy(folder.join(file), copy.path().join(file)).unwrap();
    }
    copy
}

/// A run on a bench, partly in the write-ahead log only.
async fn with_run() -> (TempDir, Store, RunId) {
    let (folder, store) = fresh().await;
    let run = store.create_run(&new_run()).await.unwrap();
    commit(&store, run, RunState::Running, rows(0, 500)).await;
    store.block_bench("joint-a", Some(run), "smoke").await.unwrap();
    (folder, store, run)
}

#[test]
fn a_removed_write_ahead_file_is_noticed_and_blocks_the_benches() {
    block_on(async {
        let (folder, store, _) = with_run().await;
        let copy = copy_when_marked(folder.path(), &store).await;
        fs::remove_file(copy.path().join("jointbench.db-wal")).unwrap();

        let report = verify(copy.path()).await.unwrap();
        assert!(!report.is_whole() && report.lost.len() == 1, "{report:?}");
        let found = Store::open(copy.path()).await.unwrap();
        let [Loss { first, last, noticed_at: Some(_) }] = found.losses().await.unwrap()[..] else { panic!("one loss") };
        assert!(first == report.lost[0].first && last == report.lost[0].last && first < last);
        assert_eq!(found.health().lost, found.losses().await.unwrap());
        assert_eq!(found.bench_block("joint-a").await.unwrap(), None, "nothing that is left names the bench");
        found.block_where_missing(["joint-a"]).await.unwrap();
        let block = found.bench_block("joint-a").await.unwrap().expect("a stop may be missing");
        found.block_where_missing(["joint-a"]).await.unwrap();
        assert_eq!(found.bench_block("joint-a").await.unwrap(), Some(block), "reported once");
        found.close().await;
        drop(found);
        let again = Store::open(copy.path()).await.unwrap();
        again.block_where_missing(["joint-b"]).await.unwrap();
        assert_eq!(again.bench_block("joint-b").await.unwrap(), None);
        assert_eq!(again.losses().await.unwrap().len(), 1, "noticed once");
        assert!(verify(copy.path()).await.unwrap().is_whole(), "what is left is whole");
    });
}

#[test]
fn a_cut_write_ahead_file_is_noticed_and_blocks_the_benches() {
    block_on(async {
        let (folder, store, run) = with_run().await;
        store.commit(run, RunState::Completed, &[], Trace::default()).await.unwrap();
        wait_for_checkpoint(folder.path()).await;
        store.acknowledge_bench("joint-a", &now(), "looked", "Anna").await.unwrap();
        store.block_bench("joint-a", None, "smoke again").await.unwrap();
        let copy = copy_when_marked(folder.path(), &store).await;
        let wal = copy.path().join("jointbench.db-wal");
        let length = fs::metadata(&wal).unwrap().len();
        assert!(length > 0 && length < 1_000_000, "{length}: a run that ends is moved into the database");
        fs::OpenOptions::new().write(true).open(&wal).unwrap().set_len(length - 1).unwrap();

        let found = Store::open(copy.path()).await.unwrap();
        assert_eq!(found.losses().await.unwrap().len(), 1);
        let block = found.bench_block("joint-a").await.unwrap().expect("a stop may be missing");
        assert!(block.reason.contains("jointbench.db-wal was removed or cut"), "{}", block.reason);
        check_rows(&found, run, 500).await;
        found.acknowledge_bench("joint-a", &now(), "looked at it", "Anna").await.unwrap();
        assert_eq!(found.bench_block("joint-a").await.unwrap(), None);
    });
}

#[test]
fn what_is_whole_raises_no_alarm() {
    block_on(async {
        let (folder, store, _) = with_run().await;
        let copy = copy_when_marked(folder.path(), &store).await;
        assert_eq!(Store::open(copy.path()).await.unwrap().losses().await.unwrap(), []);
        store.close().await;
        drop(store);
        assert!(!folder.path().join("jointbench.db-wal").exists(), "an orderly end leaves none");
        assert!(verify(folder.path()).await.unwrap().is_whole());
        assert_eq!(Store::open(folder.path()).await.unwrap().losses().await.unwrap(), []);
    });
}

#[test]
fn a_mark_that_is_behind_or_of_another_store_raises_no_alarm() {
    block_on(async {
        let (folder, store, _) = with_run().await;
        let behind = copy_when_marked(folder.path(), &store).await;
        store.acknowledge_bench("joint-a", &now(), "looked", "Anna").await.unwrap();
        let ahead = copy_when_marked(folder.path(), &store).await;
        let (other_folder, other_store) = fresh().await;
        other_store.create_run(&new_run()).await.unwrap();
        let other = copy_when_marked(other_folder.path(), &other_store).await;
        let marks = [&behind, &ahead, &other].map(|copy| Mark::read(copy.path()).unwrap());
        assert!(marks[0].store == marks[1].store && marks[0].changes < marks[1].changes);
        assert!(marks[2].store != marks[1].store && marks[2].changes > 0);

        // As after a power failure: the database is on the disk, the last mark is not.
        fs::copy(behind.path().join("jointbench.mark"), ahead.path().join("jointbench.mark")).unwrap();
        assert_eq!(Store::open(ahead.path()).await.unwrap().losses().await.unwrap(), []);
        // A mark with more changes, which belongs to another store.
        fs::copy(folder.path().join("jointbench.mark"), other.path().join("jointbench.mark")).unwrap();
        assert_eq!(Store::open(other.path()).await.unwrap().losses().await.unwrap(), []);
    });
}

#[test]
fn a_second_daemon_is_refused_without_the_lock_file() {
    block_on(async {
        let (folder, store) = fresh().await;
        fs::remove_file(folder.path().join("lock")).unwrap();
        let second = Store::open(folder.path()).await.unwrap_err();
        assert!(matches!(second, StoreError::InUse { .. }), "{second}");
        let run = store.create_run(&new_run()).await.unwrap();
        commit(&store, run, RunState::Running, rows(0, 10)).await;
        store.close().await;
        drop(store);
        check_rows(&Store::open(folder.path()).await.unwrap(), run, 10).await;
    });
}
