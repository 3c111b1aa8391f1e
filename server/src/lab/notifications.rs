//! Notifications: one task for each target delivers the messages of the outbox in order. No run, guard or stop waits for
//! it, and no target waits for another one.

use super::background::{LOOK, Tasks, pause};
use super::{Answer, Lab, LabError};
use crate::config::{Notify, NotifyTarget};
use crate::notify::deliver;
use crate::store::{NotificationRecord, Store};
use crate::view::{Notification, NotificationTarget, NotificationTest, word};
use jiff::{SignedDuration, Timestamp};
use std::time::Duration;

/// A message is given up after this time.
const PATIENCE: SignedDuration = SignedDuration::from_hours(24);

/// The targets and their tasks.
#[derive(Default)]
pub(super) struct Notifications {
    dashboard: Option<String>,
    targets: Vec<NotifyTarget>,
    tasks: Tasks,
}

impl Notifications {
    /// From now on the store writes a message for each event that a target wants.
    pub async fn open(notify: Notify, store: &Store) -> Answer<Self> {
        let Notify { dashboard, targets } = notify;
        let mut wanted = Vec::new();
        for NotifyTarget { name, events, .. } in &targets {
            wanted.extend(events.iter().map(|event| (name.clone(), word(event))));
        }
        let removed = store.set_notify_targets(&wanted).await?;
        if removed > 0 {
            tracing::warn!(removed, "waiting notifications of targets that the bench description no longer has");
        }
        Ok(Self { dashboard, targets, tasks: Tasks::default() })
    }

    /// Ends all deliveries; the messages are kept.
    pub fn abort(&self) {
        self.tasks.abort();
    }

    fn link(&self, page: &str) -> Option<String> {
        self.dashboard.as_ref().map(|dashboard| format!("{dashboard}{page}"))
    }
}

impl Lab {
    /// Starts the task of each target.
    pub(super) fn open_notifications(&self) {
        for target in &self.inner.notifications.targets {
            self.inner.notifications.tasks.spawn(self.clone().serve_target(target.clone()));
        }
    }

    async fn serve_target(self, target: NotifyTarget) {
        loop {
            match self.deliver_next(&target).await {
                Ok(true) => {}
                Ok(false) => tokio::time::sleep(LOOK).await,
                Err(fault) => {
                    tracing::error!(target.name, %fault, "the notifications wait");
                    tokio::time::sleep(LOOK).await;
                }
            }
        }
    }

    /// One attempt for the message that is due. Returns whether there was one.
    async fn deliver_next(&self, target: &NotifyTarget) -> Answer<bool> {
        let store = &self.inner.store;
        let Some(record) = store.next_notification(&target.name).await? else { return Ok(false) };
        let (id, event) = (record.id, record.event.clone());
        let body = match &record.body {
            Some(body) => body.clone(),
            None => {
                let body = body(&self.notification(&record).await)?;
                store.keep_notification_body(id, &body).await?;
                body
            }
        };
        match deliver(&target.channel, &body).await {
            Ok(()) => {
                tracing::info!(target.name, event, "notification delivered");
                self.end_notification(id, None).await;
            }
            Err(fault) if is_old(&record) => {
                tracing::error!(target.name, event, fault, "notification given up after a day");
                self.end_notification(id, Some(&fault)).await;
            }
            Err(fault) => {
                tracing::warn!(target.name, event, fault, "notification not delivered, it is repeated");
                store.retry_notification(id, Timestamp::now() + jittered_pause(record.attempts), &fault).await?;
            }
        }
        Ok(true)
    }

    /// Retries until the end is stored, because a full disk must not repeat a message.
    async fn end_notification(&self, id: i64, error: Option<&str>) {
        while let Err(fault) = self.inner.store.end_notification(id, error).await {
            tracing::error!(%fault, "the delivery of a notification is not yet stored");
            tokio::time::sleep(LOOK).await;
        }
    }

    /// A message as its target receives it. A run that cannot be read is named only.
    async fn notification(&self, record: &NotificationRecord) -> Notification {
        let run = match record.run {
            Some(id) => {
                let run = self.run(id).await;
                run.inspect_err(|fault| tracing::warn!(run.id = id, %fault, "a notification has no details")).ok()
            }
            None => None,
        };
        let summary = match (&record.reason, &run) {
            (Some(reason), _) => format!("bench {}: {reason}", record.bench),
            (None, Some(run)) => run.ending(),
            (None, None) => format!("bench {}: {}", record.bench, record.event),
        };
        let page = record.run.map_or_else(|| "/".to_owned(), |run| format!("/runs/{run}"));
        let of_run = run.map(|run| run.summary);
        Notification {
            id: record.key.clone(),
            event: record.event.clone(),
            time: record.created_at.clone(),
            bench: Some(record.bench.clone()),
            run: record.run,
            procedure: of_run.as_ref().map(|run| run.procedure.clone()),
            unit: of_run.as_ref().and_then(|run| Some(run.unit.as_ref()?.serial.clone())),
            state: of_run.as_ref().map(|run| run.state),
            verdict: of_run.as_ref().and_then(|run| run.verdict),
            limits: of_run.as_ref().and_then(|run| run.limits),
            summary,
            link: self.inner.notifications.link(&page),
        }
    }

    /// The targets, without secrets.
    pub async fn notification_targets(&self) -> Answer<Vec<NotificationTarget>> {
        let mut targets = Vec::new();
        for NotifyTarget { name, events, channel } in &self.inner.notifications.targets {
            let counts = self.inner.store.notify_counts(name).await?;
            targets.push(NotificationTarget {
                name: name.clone(),
                kind: channel.kind().to_owned(),
                events: events.clone(),
                pending: counts.pending,
                failed: counts.failed,
                last_delivery: counts.last_delivery,
                last_error: counts.last_error,
            });
        }
        Ok(targets)
    }

    /// Sends a test message to each target at the same time, without the outbox.
    pub async fn test_notifications(&self, by: &str) -> Answer<Vec<NotificationTest>> {
        let message = Notification {
            id: format!("{:032x}", rand::random::<u128>()),
            event: "test".to_owned(),
            time: format!("{:.3}", Timestamp::now()),
            summary: format!("test message of jointbench, requested by {by}"),
            link: self.inner.notifications.link("/"),
            ..Notification::default()
        };
        let body = body(&message)?;
        let send = |target: &NotifyTarget| {
            let (target, body) = (target.clone(), body.clone());
            tokio::spawn(async move {
                let error = deliver(&target.channel, &body).await.err();
                NotificationTest { kind: target.channel.kind().to_owned(), name: target.name, error }
            })
        };
        let tests: Vec<_> = self.inner.notifications.targets.iter().map(send).collect();
        let mut outcomes = Vec::new();
        for test in tests {
            match test.await {
                Ok(outcome) => outcomes.push(outcome),
                Err(fault) => tracing::error!(%fault, "a test message failed"),
            }
        }
        Ok(outcomes)
    }
}

fn body(message: &Notification) -> Answer<String> {
    serde_json::to_string(message).map_err(|fault| LabError::Internal(fault.to_string()))
}

fn is_old(record: &NotificationRecord) -> bool {
    let created: Option<Timestamp> = record.created_at.parse().ok();
    created.is_none_or(|created| Timestamp::now().duration_since(created) > PATIENCE)
}

/// Time before the next attempt, random by ± 20 %, so that targets behind one server do not come together.
fn jittered_pause(attempts: u32) -> Duration {
    pause(attempts).mul_f64(rand::random_range(0.8..1.2))
}
