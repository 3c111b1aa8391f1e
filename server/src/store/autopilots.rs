//! Autopilots and their steps. Steps are only appended.

use super::seal::AUTOPILOT_STEPS;
use super::values::{json, now};
use super::{AutopilotRecord, Store, StoreError};
use serde_json::{Map, Value};
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

impl Store {
    /// `state` is the initial state.
    pub async fn create_autopilot(
        &self,
        bench: &str,
        request: &Map<String, Value>,
        state: &str,
    ) -> Result<i64, StoreError> {
        let inserted = sqlx::query("INSERT INTO autopilots (bench, request, state, created_at) VALUES (?, ?, ?, ?)")
            .bind(bench)
            .bind(serde_json::to_string(request)?)
            .bind(state)
            .bind(now())
            .execute(&self.writer)
            .await?;
        Ok(inserted.last_insert_rowid())
    }

    /// Appends a step, sets its number and its time. `step` is an object.
    pub async fn append_autopilot_step(&self, autopilot: i64, mut step: Value) -> Result<Value, StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let last: i64 =
            sqlx::query_scalar("SELECT COALESCE(MAX(sequence), 0) FROM autopilot_steps WHERE autopilot = ?")
                .bind(autopilot)
                .fetch_one(&mut *writer)
                .await?;
        step["sequence"] = (last + 1).into();
        step["at"] = now().into();
        let text = serde_json::to_string(&step)?;
        let cells = [autopilot.into(), (last + 1).into(), (&text).into()];
        AUTOPILOT_STEPS.insert(&cells).execute(&mut *writer).await?;
        writer.commit().await?;
        Ok(step)
    }

    pub async fn end_autopilot(&self, autopilot: i64, state: &str, reason: &str) -> Result<(), StoreError> {
        sqlx::query("UPDATE autopilots SET state = ?, reason = ?, finished_at = ? WHERE id = ?")
            .bind(state)
            .bind(reason)
            .bind(now())
            .bind(autopilot)
            .execute(&self.writer)
            .await?;
        Ok(())
    }

    /// Ends the autopilots that an ended daemon left open.
    pub async fn interrupt_open_autopilots(&self, state: &str, reason: &str) -> Result<u64, StoreError> {
        let ended =
            sqlx::query("UPDATE autopilots SET state = ?, reason = ?, finished_at = ? WHERE finished_at IS NULL")
                .bind(state)
                .bind(reason)
                .bind(now())
                .execute(&self.writer)
                .await?;
        Ok(ended.rows_affected())
    }

    pub async fn autopilot(&self, id: i64) -> Result<AutopilotRecord, StoreError> {
        let row = sqlx::query("SELECT * FROM autopilots WHERE id = ?").bind(id).fetch_optional(&self.readers).await?;
        self.with_steps(&row.ok_or(StoreError::NoAutopilot(id))?).await
    }

    /// All autopilots, newest first. A damaged one is omitted and logged.
    pub async fn autopilots(&self) -> Result<Vec<AutopilotRecord>, StoreError> {
        let rows = sqlx::query("SELECT * FROM autopilots ORDER BY id DESC").fetch_all(&self.readers).await?;
        let mut records = Vec::new();
        for row in &rows {
            match self.with_steps(row).await {
                Err(fault @ StoreError::Damaged(_)) => tracing::error!(%fault, "an autopilot is left out"),
                record => records.push(record?),
            }
        }
        Ok(records)
    }

    async fn with_steps(&self, row: &SqliteRow) -> Result<AutopilotRecord, StoreError> {
        let id: i64 = row.try_get("id")?;
        let query = "SELECT * FROM autopilot_steps WHERE autopilot = ? ORDER BY sequence";
        let steps = sqlx::query(query).bind(id).fetch_all(&self.readers).await?;
        let step = |row| {
            AUTOPILOT_STEPS.check(row)?;
            json(row, "step")
        };
        Ok(AutopilotRecord {
            id,
            bench: row.try_get("bench")?,
            request: json(row, "request")?,
            state: row.try_get("state")?,
            reason: row.try_get("reason")?,
            steps: steps.iter().map(step).collect::<Result<_, StoreError>>()?,
            created_at: row.try_get("created_at")?,
            finished_at: row.try_get("finished_at")?,
        })
    }
}
