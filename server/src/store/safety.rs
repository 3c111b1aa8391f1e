//! Which bench must not move until a person has looked at it.

use super::runs::now;
use super::{BenchBlock, Store, StoreError};
use jointbench_procedure::{RunId, Safe};
use sqlx::SqliteConnection;

impl Store {
    /// Why the bench must not move, or `None`.
    pub async fn bench_block(&self, bench: &str) -> Result<Option<BenchBlock>, StoreError> {
        let newest: Option<(bool, String, String, Option<RunId>)> = sqlx::query_as(
            "SELECT blocked, reason, at, run FROM bench_safety WHERE bench = ? ORDER BY id DESC LIMIT 1",
        )
        .bind(bench)
        .fetch_optional(&self.readers)
        .await?;
        Ok(newest.and_then(|(blocked, reason, since, run)| blocked.then_some(BenchBlock { reason, since, run })))
    }

    pub async fn block_bench(&self, bench: &str, run: Option<RunId>, reason: &str) -> Result<(), StoreError> {
        enter(&mut *self.writer.acquire().await?, bench, true, run, reason).await
    }

    /// A person has looked; `reason` is what they say about it.
    pub async fn acknowledge_bench(&self, bench: &str, reason: &str) -> Result<(), StoreError> {
        enter(&mut *self.writer.acquire().await?, bench, false, None, reason).await
    }
}

async fn enter(
    writer: &mut SqliteConnection,
    bench: &str,
    blocked: bool,
    run: Option<RunId>,
    reason: &str,
) -> Result<(), StoreError> {
    sqlx::query("INSERT INTO bench_safety (bench, blocked, reason, run, at) VALUES (?, ?, ?, ?, ?)")
        .bind(bench)
        .bind(blocked)
        .bind(reason)
        .bind(run)
        .bind(now())
        .execute(writer)
        .await?;
    Ok(())
}

/// Keeps what securing has reached with the run, and blocks the bench where that is not known to be safe.
pub(super) async fn keep_safe(writer: &mut SqliteConnection, run: RunId, safe: Safe) -> Result<(), StoreError> {
    let word = serde_json::to_value(safe)?;
    let bench: String = sqlx::query_scalar("UPDATE runs SET safe = ? WHERE id = ? RETURNING bench")
        .bind(word.as_str())
        .bind(run)
        .fetch_one(&mut *writer)
        .await?;
    if safe == Safe::UnsafeUnknown {
        let reason = format!("run {run} ended without the bench being known to be safe");
        enter(writer, &bench, true, Some(run), &reason).await?;
    }
    Ok(())
}
