//! The outbox of notifications. Triggers of the schema (0026) write its messages.

use super::values::now;
use super::{NotificationRecord, NotifyCounts, Store, StoreError};
use jiff::{SignedDuration, Timestamp};
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

/// Ended messages are kept for this time.
const KEPT: SignedDuration = SignedDuration::from_hours(7 * 24);

impl Store {
    /// Sets who wants which event, and removes the messages of other targets. Returns how many of them were waiting.
    pub async fn set_notify_targets(&self, wanted: &[(String, String)]) -> Result<usize, StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        sqlx::query("DELETE FROM notify_targets").execute(&mut *writer).await?;
        for (target, event) in wanted {
            let insert = sqlx::query("INSERT INTO notify_targets (target, event) VALUES (?, ?)");
            insert.bind(target).bind(event).execute(&mut *writer).await?;
        }
        let removed: Vec<String> = sqlx::query_scalar(
            "DELETE FROM notifications WHERE target NOT IN (SELECT target FROM notify_targets) RETURNING state",
        )
        .fetch_all(&mut *writer)
        .await?;
        writer.commit().await?;
        Ok(removed.iter().filter(|state| *state == "pending").count())
    }

    /// The message that a target gets next, if it is due: the oldest one. A message that is not due for its first attempt
    /// delays no other.
    pub async fn next_notification(&self, target: &str) -> Result<Option<NotificationRecord>, StoreError> {
        let query = "SELECT * FROM (SELECT * FROM notifications WHERE target = ?1 AND state = 'pending' \
            AND (attempts > 0 OR due_at <= ?2) ORDER BY id LIMIT 1) WHERE due_at <= ?2";
        let row = sqlx::query(query).bind(target).bind(now()).fetch_optional(&self.readers).await?;
        row.as_ref().map(record).transpose()
    }

    /// The result of a run is known, or will not be: its messages are due.
    pub async fn release_notifications(&self, run: i64) -> Result<(), StoreError> {
        let query =
            "UPDATE notifications SET due_at = MIN(due_at, ?) WHERE run = ? AND state = 'pending' AND attempts = 0";
        sqlx::query(query).bind(now()).bind(run).execute(&self.writer).await?;
        Ok(())
    }

    /// Keeps the text of a message for all its attempts.
    pub async fn keep_notification_body(&self, id: i64, body: &str) -> Result<(), StoreError> {
        let keep = sqlx::query("UPDATE notifications SET body = ? WHERE id = ?");
        keep.bind(body).bind(id).execute(&self.writer).await?;
        Ok(())
    }

    /// An attempt has failed; the next one is due at `due`.
    pub async fn retry_notification(&self, id: i64, due: Timestamp, error: &str) -> Result<(), StoreError> {
        let retry = "UPDATE notifications SET attempts = attempts + 1, due_at = ?, error = ? WHERE id = ?";
        sqlx::query(retry).bind(format!("{due:.3}")).bind(error).bind(id).execute(&self.writer).await?;
        Ok(())
    }

    /// The message is delivered, or failed with an error. Removes old messages of its target.
    pub async fn end_notification(&self, id: i64, error: Option<&str>) -> Result<(), StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let target: String = sqlx::query_scalar(
            "UPDATE notifications SET attempts = attempts + 1, state = iif(?1 IS NULL, 'delivered', 'failed'), \
             error = ?1, ended_at = ?2 WHERE id = ?3 RETURNING target",
        )
        .bind(error)
        .bind(now())
        .bind(id)
        .fetch_one(&mut *writer)
        .await?;
        sqlx::query("DELETE FROM notifications WHERE target = ? AND state <> 'pending' AND ended_at < ?")
            .bind(target)
            .bind(format!("{:.3}", Timestamp::now() - KEPT))
            .execute(&mut *writer)
            .await?;
        Ok(writer.commit().await?)
    }

    pub async fn notify_counts(&self, target: &str) -> Result<NotifyCounts, StoreError> {
        let query = "SELECT COUNT(*) FILTER (WHERE state = 'pending') AS pending, \
            COUNT(*) FILTER (WHERE state = 'failed') AS failed, \
            MAX(ended_at) FILTER (WHERE state = 'delivered') AS last_delivery, \
            (SELECT error FROM notifications WHERE target = ?1 AND error IS NOT NULL \
                ORDER BY state = 'pending' DESC, ended_at DESC LIMIT 1) AS last_error \
            FROM notifications WHERE target = ?1";
        let row = sqlx::query(query).bind(target).fetch_one(&self.readers).await?;
        Ok(NotifyCounts {
            pending: row.try_get::<i64, _>("pending")? as u64,
            failed: row.try_get::<i64, _>("failed")? as u64,
            last_delivery: row.try_get("last_delivery")?,
            last_error: row.try_get("last_error")?,
        })
    }
}

fn record(row: &SqliteRow) -> Result<NotificationRecord, StoreError> {
    Ok(NotificationRecord {
        id: row.try_get("id")?,
        key: row.try_get("key")?,
        event: row.try_get("event")?,
        bench: row.try_get("bench")?,
        run: row.try_get("run")?,
        reason: row.try_get("reason")?,
        created_at: row.try_get("created_at")?,
        body: row.try_get("body")?,
        attempts: row.try_get::<i64, _>("attempts")? as u32,
    })
}
