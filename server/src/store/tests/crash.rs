use super::super::StoreError;
use super::*;
use jointbench_procedure::Safe;

/// A store on a copy of the files on the disk: the state at a start after kill -9.
async fn after_kill(folder: &TempDir) -> (TempDir, Store) {
    let copy = tempfile::tempdir().unwrap();
    for file in ["jointbench.db", "jointbench.db-wal"] {
        std::fs::copy(folder.path().join(file), copy.path().join(file)).unwrap();
    }
    let store = Store::open(copy.path()).await.unwrap();
    (copy, store)
}

#[test]
fn every_committed_row_is_there_once_after_a_kill() {
    block_on(async {
        let (folder, store) = fresh().await;
        let run = store.create_run(&new_run()).await.unwrap();
        store.commit(run, RunState::Arming, &[note(0.0, "armed")], Trace::default()).await.unwrap();
        // Commits before, at and after the end of a block.
        for (kept, count) in [(0, 32_000), (32_000, 500), (32_500, 500), (33_000, 500)] {
            store.commit(run, RunState::Running, &[note(kept as f64, "step")], rows(kept, count)).await.unwrap();
            let (_copy, found) = after_kill(&folder).await;
            check_rows(&found, run, kept + count).await;
        }

        let (_copy, found) = after_kill(&folder).await;
        let interrupted = found.interrupt_open_runs().await.unwrap();
        assert_eq!(
            interrupted.iter().map(|run| (run.id, run.state)).collect::<Vec<_>>(),
            [(run, RunState::Interrupted)]
        );
        assert_eq!(found.interrupt_open_runs().await.unwrap(), []);
        check_rows(&found, run, 33_500).await;
        found
            .end_run(run, RunState::Interrupted, Safe::SafeCommanded, Some("the daemon ended in mid-run"))
            .await
            .unwrap();
        let record = found.run(run).await.unwrap();
        assert_eq!((record.safe, record.state), (Some(Safe::SafeCommanded), RunState::Interrupted));
        let kinds: Vec<String> = found.events(run, 0).await.unwrap().into_iter().map(|event| event.kind).collect();
        assert_eq!(kinds, ["note", "note", "note", "note", "note", "state", "safe"]);
    });
}

#[test]
fn a_full_disk_keeps_all_before_it_and_the_end_of_a_run_when_it_is_healed() {
    block_on(async {
        let (_folder, store) = fresh().await;
        // Packing frees pages in the file; these must not accept data either.
        let before = store.create_run(&new_run()).await.unwrap();
        commit(&store, before, RunState::Running, rows(0, 20_000)).await;
        commit(&store, before, RunState::Completed, Trace::default()).await;
        let run = store.create_run(&new_run()).await.unwrap();
        commit(&store, run, RunState::Running, rows(0, 20_000)).await;
        store.fill_disk(true).await.unwrap();

        let full = store.commit(run, RunState::Running, &[note(2.0, "lost")], rows(20_000, 2_000)).await.unwrap_err();
        assert!(matches!(full, StoreError::DiskFull), "{full}");
        check_rows(&store, run, 20_000).await;
        assert_eq!(store.events(run, 0).await.unwrap(), []);
        let why = Some("the disk is full");
        let end = async || store.end_run(run, RunState::Failed, Safe::SafeVerified, why).await;
        let full = end().await.unwrap_err();
        assert!(matches!(full, StoreError::DiskFull), "{full}");
        assert_eq!(store.run(run).await.unwrap().state, RunState::Running, "all of it, or nothing");

        store.fill_disk(false).await.unwrap();
        end().await.unwrap();
        let record = store.run(run).await.unwrap();
        assert_eq!(
            (record.state, record.safe, record.reason.as_deref()),
            (RunState::Failed, Some(Safe::SafeVerified), why)
        );
        check_rows(&store, run, 20_000).await;
        let next = store.create_run(&new_run()).await.unwrap();
        commit(&store, next, RunState::Running, rows(0, 33_000)).await;
        check_rows(&store, next, 33_000).await;
    });
}
