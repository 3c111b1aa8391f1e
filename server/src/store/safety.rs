//! Benches that must not move until a person has checked them.

use super::seal::BENCH_SAFETY;
use super::values::now;
use super::{SafetyRecord, Store, StoreError};
use jointbench_procedure::{RunId, Safe};
use sqlx::sqlite::SqliteRow;
use sqlx::{Row, SqliteConnection};

impl Store {
    /// The reason why the bench must not move, or `None`.
    ///
    /// If the newest entry is damaged, a release cannot be confirmed: the bench is blocked again.
    pub async fn bench_block(&self, bench: &str) -> Result<Option<SafetyRecord>, StoreError> {
        let newest = match self.newest_entry(bench).await {
            Err(StoreError::Damaged(what)) => {
                let reason = format!("the newest entry of the safety record is damaged ({what}): look at the bench");
                self.block_bench(bench, None, &reason).await?;
                self.newest_entry(bench).await?
            }
            newest => newest?,
        };
        Ok(newest.filter(|newest| newest.blocked))
    }

    async fn newest_entry(&self, bench: &str) -> Result<Option<SafetyRecord>, StoreError> {
        let query = "SELECT * FROM bench_safety WHERE bench = ? ORDER BY id DESC LIMIT 1";
        let row = sqlx::query(query).bind(bench).fetch_optional(&self.readers).await?;
        row.as_ref().map(record).transpose()
    }

    /// The newest entries of a bench, newest first. A damaged entry is shown as a block with the error as its reason.
    pub async fn safety(&self, bench: &str, limit: u32) -> Result<Vec<SafetyRecord>, StoreError> {
        let query = "SELECT * FROM bench_safety WHERE bench = ? ORDER BY id DESC LIMIT ?";
        let rows = sqlx::query(query).bind(bench).bind(limit).fetch_all(&self.readers).await?;
        let damaged = |row: &SqliteRow, fault: StoreError| SafetyRecord {
            blocked: true,
            stopped: false,
            reason: fault.to_string(),
            run: None,
            by: None,
            at: row.try_get("at").unwrap_or_default(),
        };
        Ok(rows.iter().map(|row| record(row).unwrap_or_else(|fault| damaged(row, fault))).collect())
    }

    /// Stores a block with its original time. Skips a block that is already stored.
    pub async fn keep_block(&self, bench: &str, block: &SafetyRecord) -> Result<(), StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let there: bool = sqlx::query_scalar(
            "SELECT EXISTS (SELECT 1 FROM bench_safety WHERE bench = ? AND at = ? AND reason = ? AND blocked)",
        )
        .bind(bench)
        .bind(&block.at)
        .bind(&block.reason)
        .fetch_one(&mut *writer)
        .await?;
        if !there {
            insert(&mut writer, bench, block).await?;
        }
        Ok(writer.commit().await?)
    }

    /// Blocks every known bench, because a stop may be lost.
    pub async fn block_benches(&self, reason: &str) -> Result<(), StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        block_all(&mut writer, reason).await?;
        Ok(writer.commit().await?)
    }

    pub async fn block_bench(&self, bench: &str, run: Option<RunId>, reason: &str) -> Result<(), StoreError> {
        enter(&mut *self.writer.acquire().await?, bench, Word::Block, run, reason, None).await
    }

    /// Releases the block that began at `since`; `reason` is the statement of the person. Returns `false` and releases
    /// nothing if the stop was pressed again since.
    pub async fn acknowledge_bench(
        &self,
        bench: &str,
        since: &str,
        reason: &str,
        by: &str,
    ) -> Result<bool, StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let pressed_again: bool = sqlx::query_scalar(
            "SELECT EXISTS (SELECT 1 FROM bench_safety WHERE bench = ?1 AND stopped AND at > ?2 \
             AND id > (SELECT COALESCE(MAX(id), 0) FROM bench_safety WHERE bench = ?1 AND NOT blocked))",
        )
        .bind(bench)
        .bind(since)
        .fetch_one(&mut *writer)
        .await?;
        if !pressed_again {
            enter(&mut writer, bench, Word::Release, None, reason, Some(by)).await?;
        }
        writer.commit().await?;
        Ok(!pressed_again)
    }
}

fn record(row: &SqliteRow) -> Result<SafetyRecord, StoreError> {
    BENCH_SAFETY.check(row)?;
    Ok(SafetyRecord {
        blocked: row.try_get("blocked")?,
        stopped: row.try_get("stopped")?,
        reason: row.try_get("reason")?,
        run: row.try_get("run")?,
        by: row.try_get("who")?,
        at: row.try_get("at")?,
    })
}

#[derive(Clone, Copy, PartialEq)]
enum Word {
    Block,
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
    let record = SafetyRecord {
        blocked: word != Word::Release,
        stopped: false,
        reason: reason.to_owned(),
        run,
        by: by.map(str::to_owned),
        at: now(),
    };
    insert(writer, bench, &record).await
}

async fn insert(writer: &mut SqliteConnection, bench: &str, record: &SafetyRecord) -> Result<(), StoreError> {
    let cells = [
        bench.into(),
        record.blocked.into(),
        record.stopped.into(),
        (&record.reason).into(),
        record.run.into(),
        record.by.as_ref().into(),
        (&record.at).into(),
    ];
    BENCH_SAFETY.insert(&cells).execute(writer).await?;
    Ok(())
}

/// Blocks a bench for an internal reason of the store.
pub(super) async fn block(writer: &mut SqliteConnection, bench: &str, reason: &str) -> Result<(), StoreError> {
    enter(writer, bench, Word::Block, None, reason, None).await
}

/// The same for every known bench.
pub(super) async fn block_all(writer: &mut SqliteConnection, reason: &str) -> Result<(), StoreError> {
    let benches: Vec<String> =
        sqlx::query_scalar("SELECT bench FROM bench_safety UNION SELECT bench FROM runs WHERE procedure <> 'import'")
            .fetch_all(&mut *writer)
            .await?;
    for bench in benches {
        block(writer, &bench, reason).await?;
    }
    Ok(())
}

/// Stores the safe state of the run, and blocks the bench unless it is known to be safe.
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
