//! Which bench must not move until a person has looked at it.

use super::runs::now;
use super::{SafetyRecord, Store, StoreError};
use jointbench_procedure::{RunId, Safe};
use sqlx::SqliteConnection;

type Row = (bool, bool, String, Option<RunId>, Option<String>, String);

impl Store {
    /// Why the bench must not move, or `None`.
    pub async fn bench_block(&self, bench: &str) -> Result<Option<SafetyRecord>, StoreError> {
        Ok(self.safety(bench, 1).await?.pop().filter(|newest| newest.blocked))
    }

    /// The newest entries of a bench, newest first.
    pub async fn safety(&self, bench: &str, limit: u32) -> Result<Vec<SafetyRecord>, StoreError> {
        let entries: Vec<Row> = sqlx::query_as(
            "SELECT blocked, stopped, reason, run, who, at FROM bench_safety WHERE bench = ? ORDER BY id DESC LIMIT ?",
        )
        .bind(bench)
        .bind(limit)
        .fetch_all(&self.readers)
        .await?;
        let record = |(blocked, stopped, reason, run, by, at)| SafetyRecord { blocked, stopped, reason, run, by, at };
        Ok(entries.into_iter().map(record).collect())
    }

    pub async fn block_bench(&self, bench: &str, run: Option<RunId>, reason: &str) -> Result<(), StoreError> {
        enter(&mut *self.writer.acquire().await?, bench, Word::Block, run, reason, None).await
    }

    /// A person has pressed the software stop.
    pub async fn stop_bench(&self, bench: &str, run: Option<RunId>, reason: &str, by: &str) -> Result<(), StoreError> {
        enter(&mut *self.writer.acquire().await?, bench, Word::Stop, run, reason, Some(by)).await
    }

    /// A person has looked; `reason` is what they say about it.
    pub async fn acknowledge_bench(&self, bench: &str, reason: &str, by: &str) -> Result<(), StoreError> {
        enter(&mut *self.writer.acquire().await?, bench, Word::Release, None, reason, Some(by)).await
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Word {
    Block,
    Stop,
    Release,
}

async fn enter(
    writer: &mut SqliteConnection,
    bench: &str,
    word: Word,
    run: Option<RunId>,
    reason: &str,
    by: Option<&str>,
) -> Result<(), StoreError> {
    sqlx::query(
        "INSERT INTO bench_safety (bench, blocked, stopped, reason, run, who, at) VALUES (?, ?, ?, ?, ?, ?, ?)",
    )
    .bind(bench)
    .bind(word != Word::Release)
    .bind(word == Word::Stop)
    .bind(reason)
    .bind(run)
    .bind(by)
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
        enter(writer, &bench, Word::Block, Some(run), &reason, None).await?;
    }
    Ok(())
}
