//! The triggers of the outbox, and its order.

use super::super::{NotificationRecord, SafetyRecord};
use super::*;
use jiff::{SignedDuration, Timestamp};
use jointbench_procedure::{Control, Safe};

const TARGET: &str = "ada";

/// A store with one target for all events.
async fn subscribed() -> (TempDir, Store) {
    let (folder, store) = fresh().await;
    let events = ["finished", "failed", "unsafe", "needs_hand"];
    let wanted: Vec<_> = events.map(|event| (TARGET.to_owned(), event.to_owned())).into();
    store.set_notify_targets(&wanted).await.unwrap();
    (folder, store)
}

/// Takes all messages that are due: event, run and reason.
async fn delivered(store: &Store) -> Vec<(String, Option<RunId>, Option<String>)> {
    let mut found = Vec::new();
    while let Some(NotificationRecord { id, event, run, reason, .. }) = store.next_notification(TARGET).await.unwrap() {
        store.end_notification(id, None).await.unwrap();
        found.push((event, run, reason));
    }
    found
}

fn message(event: &str, run: Option<RunId>, reason: Option<&str>) -> (String, Option<RunId>, Option<String>) {
    (event.to_owned(), run, reason.map(str::to_owned))
}

#[test]
fn the_end_of_a_run_has_one_message_and_an_import_none() {
    block_on(async {
        let (_folder, store) = subscribed().await;
        let run = store.create_run(&new_run()).await.unwrap();
        commit(&store, run, RunState::Running, rows(0, 10)).await;
        commit(&store, run, RunState::Completed, rows(10, 10)).await;
        assert_eq!(delivered(&store).await, [], "it waits for the verdict");
        store.release_notifications(run).await.unwrap();
        assert_eq!(delivered(&store).await, [message("finished", Some(run), None)]);

        let run = store.create_run(&new_run()).await.unwrap();
        store.end_run(run, RunState::Interrupted, Safe::SafeVerified, Some("the worker ended")).await.unwrap();
        assert_eq!(delivered(&store).await, [message("failed", Some(run), None)]);
        store.import(&NewRun { procedure: "import".into(), ..new_run() }, &[], rows(0, 3)).await.unwrap();
        assert_eq!(store.notify_counts(TARGET).await.unwrap().pending, 0);
    });
}

#[test]
fn a_block_has_one_message_until_it_is_released() {
    block_on(async {
        let (_folder, store) = subscribed().await;
        let block = |stopped: bool, reason: &str, at: &str| SafetyRecord {
            blocked: true,
            stopped,
            reason: reason.into(),
            run: None,
            by: None,
            at: at.into(),
        };
        let enter = async |stopped: bool, reason: &str, at: &str| {
            store.keep_block("joint-a", &block(stopped, reason, at)).await.unwrap();
        };
        enter(false, "not read back", "2026-01-01T00:00:00Z").await;
        enter(false, "the drive is silent", "2026-01-01T00:00:01Z").await;
        assert_eq!(delivered(&store).await, [message("unsafe", None, Some("not read back"))]);
        store.acknowledge_bench("joint-a", "2026-01-01T00:00:01Z", "checked", "Anna").await.unwrap();
        enter(true, "pressed", "2026-01-01T00:00:02Z").await;
        enter(true, "pressed", "2026-01-01T00:00:03Z").await;
        assert_eq!(delivered(&store).await, [message("needs_hand", None, Some("pressed"))]);
        enter(false, "not read back", "2026-01-01T00:00:04Z").await;
        assert_eq!(delivered(&store).await, [message("unsafe", None, Some("not read back"))]);
    });
}

#[test]
fn a_queue_and_a_run_that_wait_for_a_person_have_a_message() {
    block_on(async {
        let (_folder, store) = subscribed().await;
        store.pause_queue("joint-a", "requested by Anna").await.unwrap();
        store.resume_queue("joint-a").await.unwrap();
        store.pause_queue("joint-a", "run 3 is failed: inspect the bench").await.unwrap();
        store.pause_queue("joint-a", "the first reason is kept").await.unwrap();
        let reason = "queue paused: run 3 is failed: inspect the bench";
        assert_eq!(delivered(&store).await, [message("needs_hand", None, Some(reason))]);

        let run = store.create_run(&new_run()).await.unwrap();
        let control = |control| Event { at_s: 1.0, kind: EventKind::Control { control, by: None } };
        let state = |state| Event { at_s: 1.0, kind: EventKind::State { state, reason: None } };
        let requested =
            [control(Control::Pause), state(RunState::Paused), control(Control::Resume), state(RunState::Running)];
        store.commit(run, RunState::Running, &requested, Trace::default()).await.unwrap();
        assert_eq!(delivered(&store).await, []);
        let waits = [note(2.0, "Switch it off and on."), state(RunState::Paused)];
        store.commit(run, RunState::Paused, &waits, Trace::default()).await.unwrap();
        assert_eq!(delivered(&store).await, [message("needs_hand", Some(run), Some("Switch it off and on."))]);
    });
}

#[test]
fn a_failed_message_holds_the_order_and_keeps_its_text() {
    block_on(async {
        let (_folder, store) = subscribed().await;
        store.pause_queue("joint-a", "first").await.unwrap();
        store.pause_queue("joint-b", "second").await.unwrap();
        let first = store.next_notification(TARGET).await.unwrap().unwrap();
        store.keep_notification_body(first.id, "{}").await.unwrap();
        let now = Timestamp::now();
        store.retry_notification(first.id, now + SignedDuration::from_mins(5), "503").await.unwrap();
        assert_eq!(store.next_notification(TARGET).await.unwrap(), None);
        let counts = store.notify_counts(TARGET).await.unwrap();
        assert_eq!((counts.pending, counts.last_error.as_deref()), (2, Some("503")));
        store.retry_notification(first.id, now, "503").await.unwrap();
        let again = store.next_notification(TARGET).await.unwrap().unwrap();
        assert_eq!((again.key, again.body.as_deref(), again.attempts), (first.key, Some("{}"), 2));
        store.end_notification(first.id, Some("given up")).await.unwrap();
        assert_eq!(delivered(&store).await, [message("needs_hand", None, Some("queue paused: second"))]);
        let counts = store.notify_counts(TARGET).await.unwrap();
        assert_eq!((counts.pending, counts.failed, counts.last_error.as_deref()), (0, 1, Some("given up")));
        assert!(counts.last_delivery.is_some());

        store.pause_queue("joint-c", "third").await.unwrap();
        assert_eq!(store.set_notify_targets(&[]).await.unwrap(), 1, "a waiting message of a removed target");
    });
}
