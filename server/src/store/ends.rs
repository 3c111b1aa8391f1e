//! Ends of runs whose worker or daemon has ended.

use super::commit::append;
use super::runs::{LISTED, insert_events, keep_reason, listed, seal_state};
use super::values::{now, word};
use super::{RunRecord, Store, StoreError};
use jointbench_instrument::Trace;
use jointbench_procedure::{Event, EventKind, RunId, RunState, Safe};
use sqlx::QueryBuilder;

impl Store {
    /// Stores end state, safe state and reason of a run whose last commit did not contain them.
    pub async fn end_run(
        &self,
        run: RunId,
        state: RunState,
        safe: Safe,
        reason: Option<&str>,
    ) -> Result<(), StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let found: Option<(String, Option<String>)> =
            sqlx::query_as("SELECT state, safe FROM runs WHERE id = ?").bind(run).fetch_optional(&mut *writer).await?;
        let (before, secured) = found.ok_or(StoreError::NoRun(run))?;
        let at_s: f64 = sqlx::query_scalar("SELECT COALESCE(MAX(at_s), 0.0) FROM events WHERE run = ?")
            .bind(run)
            .fetch_one(&mut *writer)
            .await?;
        if secured.is_none() {
            insert_events(&mut writer, run, &[Event { at_s, kind: EventKind::Safe { safe } }]).await?;
        }
        if !word::<RunState>(&before)?.is_final() {
            let end = Event { at_s, kind: EventKind::State { state, reason: reason.map(str::to_owned) } };
            append(&mut writer, run, state, &[end], Trace::default()).await?;
        } else {
            keep_reason(&mut writer, run, reason).await?;
            seal_state(&mut writer, run).await?;
        }
        Ok(writer.commit().await?)
    }

    /// Interrupts the runs that an earlier daemon left open, and returns them. Their committed samples remain.
    ///
    /// This does not secure the bench: secure it, then call [`Store::end_run`].
    pub async fn interrupt_open_runs(&self) -> Result<Vec<RunRecord>, StoreError> {
        let open: Vec<RunId> = sqlx::query_scalar("SELECT id FROM runs WHERE finished_at IS NULL ORDER BY id")
            .fetch_all(&self.writer)
            .await?;
        let mut interrupted = Vec::new();
        for run in open {
            let at_s: f64 = sqlx::query_scalar("SELECT COALESCE(MAX(at_s), 0.0) FROM events WHERE run = ?")
                .bind(run)
                .fetch_one(&self.writer)
                .await?;
            let event = Event { at_s, kind: EventKind::State { state: RunState::Interrupted, reason: None } };
            match self.commit(run, RunState::Interrupted, &[event], Default::default()).await {
                Err(fault @ StoreError::Damaged(_)) => {
                    tracing::error!(run, %fault, "a run is ended with its last rows left as they are");
                    self.end_damaged(run).await?;
                }
                done => done?,
            }
            let mut query = QueryBuilder::new(LISTED);
            query.push(" WHERE id = ").push_bind(run);
            interrupted.push(listed(&query.build().fetch_one(&self.readers).await?));
        }
        Ok(interrupted)
    }

    /// Interrupts a run without changing its events and its last rows.
    async fn end_damaged(&self, run: RunId) -> Result<(), StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let end = sqlx::query("UPDATE runs SET state = ?, finished_at = ? WHERE id = ?");
        end.bind(RunState::Interrupted.name()).bind(now()).bind(run).execute(&mut *writer).await?;
        seal_state(&mut writer, run).await?;
        Ok(writer.commit().await?)
    }
}
