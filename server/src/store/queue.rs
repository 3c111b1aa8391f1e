//! The queues of the benches. The words of the states are those of the table.

use super::values::{json, now, text, word};
use super::{NewQueueEntry, QueueRecord, QueueState, Store, StoreError};
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

/// Entries with the states of their runs.
macro_rules! select {
    ($rest:literal) => {
        concat!(
            "SELECT queue.*, (SELECT runs.state FROM runs WHERE runs.id = queue.run) AS run_state FROM queue ",
            $rest
        )
    };
}

impl Store {
    /// Appends entries in order, all or none. Several form one plan.
    pub async fn enqueue(&self, entries: &[NewQueueEntry]) -> Result<Vec<i64>, StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let mut ids = Vec::new();
        for new in entries {
            let inserted = sqlx::query(
                "INSERT INTO queue (bench, proceed_if, request, who, priority, planned_s, key, state, created_at)
                 VALUES (?, ?, ?, ?, ?, ?, ?, 'waiting', ?)",
            )
            .bind(&new.bench)
            .bind(text(new.proceed_if)?)
            .bind(serde_json::to_string(&new.request)?)
            .bind(&new.who)
            .bind(new.priority)
            .bind(new.planned_s)
            .bind(&new.key)
            .bind(now())
            .execute(&mut *writer)
            .await?;
            ids.push(inserted.last_insert_rowid());
        }
        if let [first, _, ..] = ids.as_slice() {
            sqlx::query("UPDATE queue SET plan = ? WHERE id >= ?")
                .bind(first)
                .bind(first)
                .execute(&mut *writer)
                .await?;
        }
        writer.commit().await?;
        Ok(ids)
    }

    pub async fn queue_entry(&self, id: i64) -> Result<QueueRecord, StoreError> {
        let row = sqlx::query(select!("WHERE id = ?")).bind(id).fetch_optional(&self.readers).await?;
        record(&row.ok_or(StoreError::NoQueueEntry(id))?)
    }

    /// The entry of a repeated request.
    pub async fn queue_entry_with_key(&self, key: &str) -> Result<Option<QueueRecord>, StoreError> {
        let row = sqlx::query(select!("WHERE key = ?")).bind(key).fetch_optional(&self.readers).await?;
        row.as_ref().map(record).transpose()
    }

    /// The entry that started a run.
    pub async fn queue_entry_of_run(&self, run: i64) -> Result<Option<QueueRecord>, StoreError> {
        let row = sqlx::query(select!("WHERE run = ?")).bind(run).fetch_optional(&self.readers).await?;
        row.as_ref().map(record).transpose()
    }

    /// The waiting entries of a bench, in the order in which they start: first the rest of a test plan that has begun.
    pub async fn waiting(&self, bench: &str) -> Result<Vec<QueueRecord>, StoreError> {
        let query = select!(
            "WHERE bench = ? AND state = 'waiting' ORDER BY \
            EXISTS (SELECT 1 FROM queue AS done WHERE done.plan = queue.plan AND done.state = 'started') DESC, \
            priority DESC, COALESCE(plan, id), id"
        );
        let rows = sqlx::query(query).bind(bench).fetch_all(&self.readers).await?;
        rows.iter().map(record).collect()
    }

    /// The entries that left the queue of a bench last, the newest first.
    pub async fn left_queue(&self, bench: &str, most: u32) -> Result<Vec<QueueRecord>, StoreError> {
        let query = select!(
            "WHERE bench = ? AND state <> 'waiting' ORDER BY COALESCE(ended_at, created_at) DESC, id DESC LIMIT ?"
        );
        let rows = sqlx::query(query).bind(bench).bind(most).fetch_all(&self.readers).await?;
        rows.iter().map(record).collect()
    }

    /// Changes the state of an entry that is in state `from`; `false` if it is not.
    pub async fn set_queue_state(
        &self,
        id: i64,
        from: QueueState,
        state: QueueState,
        reason: Option<&str>,
    ) -> Result<bool, StoreError> {
        let ended_at = matches!(state, QueueState::Failed | QueueState::Removed).then(now);
        let changed = sqlx::query(
            "UPDATE queue SET state = ?, reason = ?, ended_at = ? WHERE id = ? AND state = ? AND run IS NULL",
        )
        .bind(text(state)?)
        .bind(reason)
        .bind(ended_at)
        .bind(id)
        .bind(text(from)?)
        .execute(&self.writer)
        .await?;
        Ok(changed.rows_affected() > 0)
    }

    pub async fn set_queue_run(&self, id: i64, run: i64) -> Result<(), StoreError> {
        sqlx::query("UPDATE queue SET run = ?, ended_at = ? WHERE id = ?")
            .bind(run)
            .bind(now())
            .bind(id)
            .execute(&self.writer)
            .await?;
        Ok(())
    }

    /// Sets the priority of a waiting entry and of its test plan; `false` if the entry does not wait.
    pub async fn set_queue_priority(&self, id: i64, priority: i32) -> Result<bool, StoreError> {
        let query = "UPDATE queue SET priority = ?1 WHERE state = 'waiting' \
            AND EXISTS (SELECT 1 FROM queue AS it WHERE it.id = ?2 AND it.state = 'waiting' \
                AND (it.id = queue.id OR it.plan = queue.plan))";
        let changed = sqlx::query(query).bind(priority).bind(id).execute(&self.writer).await?;
        Ok(changed.rows_affected() > 0)
    }

    /// Removes the waiting entries of a plan.
    pub async fn remove_rest_of_plan(&self, plan: i64, reason: &str) -> Result<(), StoreError> {
        let query = "UPDATE queue SET state = 'removed', reason = ?, ended_at = ? WHERE plan = ? AND state = 'waiting'";
        sqlx::query(query).bind(reason).bind(now()).bind(plan).execute(&self.writer).await?;
        Ok(())
    }

    /// Reason and time of the pause of a queue.
    pub async fn queue_pause(&self, bench: &str) -> Result<Option<(String, String)>, StoreError> {
        let query = "SELECT reason, at FROM queue_pauses WHERE bench = ?";
        Ok(sqlx::query_as(query).bind(bench).fetch_optional(&self.readers).await?)
    }

    /// The first reason stands.
    pub async fn pause_queue(&self, bench: &str, reason: &str) -> Result<(), StoreError> {
        sqlx::query("INSERT INTO queue_pauses (bench, reason, at) VALUES (?, ?, ?) ON CONFLICT DO NOTHING")
            .bind(bench)
            .bind(reason)
            .bind(now())
            .execute(&self.writer)
            .await?;
        Ok(())
    }

    pub async fn resume_queue(&self, bench: &str) -> Result<(), StoreError> {
        sqlx::query("DELETE FROM queue_pauses WHERE bench = ?").bind(bench).execute(&self.writer).await?;
        Ok(())
    }

    /// Pauses every queue with waiting entries. An entry whose start an ended daemon did not complete has failed.
    pub async fn hold_queues(&self, paused: &str, failed: &str) -> Result<(), StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        sqlx::query(
            "UPDATE queue SET state = 'failed', reason = ?, ended_at = ? WHERE state = 'started' AND run IS NULL",
        )
        .bind(failed)
        .bind(now())
        .execute(&mut *writer)
        .await?;
        sqlx::query(
            "INSERT INTO queue_pauses (bench, reason, at)
             SELECT DISTINCT bench, ?, ? FROM queue WHERE state = 'waiting' ON CONFLICT DO NOTHING",
        )
        .bind(paused)
        .bind(now())
        .execute(&mut *writer)
        .await?;
        writer.commit().await?;
        Ok(())
    }
}

fn record(row: &SqliteRow) -> Result<QueueRecord, StoreError> {
    Ok(QueueRecord {
        id: row.try_get("id")?,
        plan: row.try_get("plan")?,
        new: NewQueueEntry {
            bench: row.try_get("bench")?,
            proceed_if: word(row.try_get("proceed_if")?)?,
            request: json(row, "request")?,
            who: row.try_get("who")?,
            priority: row.try_get("priority")?,
            planned_s: row.try_get("planned_s")?,
            key: row.try_get("key")?,
        },
        state: word(row.try_get("state")?)?,
        run: row.try_get("run")?,
        run_state: row.try_get::<Option<&str>, _>("run_state")?.map(word).transpose()?,
        reason: row.try_get("reason")?,
        created_at: row.try_get("created_at")?,
        ended_at: row.try_get("ended_at")?,
    })
}
