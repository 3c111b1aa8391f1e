//! What is owed to the archive, where its files are, and the removal of archived samples. A trigger of the schema (0028)
//! writes what a run owes.

use super::result_cache::{packed, unpacked};
use super::values::now;
use super::{Store, StoreError};
use jiff::Timestamp;
use jointbench_procedure::RunId;
use serde::{Deserialize, Serialize};
use sqlx::sqlite::SqliteRow;
use sqlx::{Row, SqliteConnection};
use std::time::Duration;

/// Blocks that one transaction removes, and the pause after it: the recorder has priority on the writer.
const SLICE: i64 = 64;
const PAUSE: Duration = Duration::from_millis(50);

/// A table of a run, for the archive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArchiveRecord {
    pub run: RunId,
    /// `means` or `samples`.
    pub content: String,
    /// `owed`, `archived`, `empty` or `failed`.
    pub state: String,
    pub attempts: u32,
    /// Error of the last attempt, or why there is no table.
    pub reason: Option<String>,
    /// Folder of the archive, and path of the file in it.
    pub folder: Option<String>,
    pub path: Option<String>,
    pub bytes: Option<u64>,
    pub sha256: Option<String>,
    pub archived_at: Option<String>,
    /// The store no longer holds the samples.
    pub dropped_at: Option<String>,
}

/// How the work for a table ends.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum ArchiveEnd {
    Archived { folder: String, path: String, bytes: u64, sha256: String },
    Empty(String),
    Failed(String),
}

/// Numbers of tables.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArchiveCounts {
    pub owed: u64,
    pub archived: u64,
    pub failed: u64,
    pub empty: u64,
    pub dropped: u64,
    pub oldest_owed: Option<String>,
    pub last_error: Option<String>,
}

impl Store {
    /// Identifier of this store.
    pub async fn store_id(&self) -> Result<String, StoreError> {
        Ok(sqlx::query_scalar("SELECT store FROM store_log").fetch_one(&self.readers).await?)
    }

    /// Sets which tables a run owes when it ends, and removes debts of other tables. Returns their number.
    pub async fn set_archive_contents(&self, contents: &[String]) -> Result<u64, StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        sqlx::query("DELETE FROM archive_contents").execute(&mut *writer).await?;
        for content in contents {
            let insert = sqlx::query("INSERT INTO archive_contents (content) VALUES (?)");
            insert.bind(content).execute(&mut *writer).await?;
        }
        let removed = sqlx::query(
            "DELETE FROM archive WHERE state IN ('owed', 'failed') \
             AND content NOT IN (SELECT content FROM archive_contents)",
        );
        let removed = removed.execute(&mut *writer).await?.rows_affected();
        writer.commit().await?;
        Ok(removed)
    }

    /// The table that is archived next: of those that are due, the one that waits longest.
    pub async fn next_archive(&self) -> Result<Option<ArchiveRecord>, StoreError> {
        let query = "SELECT * FROM archive WHERE state = 'owed' AND due_at <= ? ORDER BY due_at, run, content LIMIT 1";
        let row = sqlx::query(query).bind(now()).fetch_optional(&self.readers).await?;
        row.as_ref().map(record).transpose()
    }

    /// An attempt has failed; the next one is due at `due`.
    pub async fn retry_archive(
        &self,
        run: RunId,
        content: &str,
        due: Timestamp,
        reason: &str,
    ) -> Result<(), StoreError> {
        let retry = "UPDATE archive SET attempts = attempts + 1, due_at = ?, reason = ? \
            WHERE run = ? AND content = ? AND state = 'owed'";
        let retry = sqlx::query(retry).bind(format!("{due:.3}")).bind(reason).bind(run).bind(content);
        retry.execute(&self.writer).await?;
        Ok(())
    }

    /// The table is archived, does not exist, or cannot be archived.
    pub async fn end_archive(&self, run: RunId, content: &str, end: &ArchiveEnd) -> Result<(), StoreError> {
        let query = match end {
            ArchiveEnd::Archived { folder, path, bytes, sha256 } => sqlx::query(
                "UPDATE archive SET state = 'archived', attempts = attempts + 1, reason = NULL, folder = ?, path = ?, \
                 bytes = ?, sha256 = ?, archived_at = ? WHERE run = ? AND content = ? AND state = 'owed'",
            )
            .bind(folder)
            .bind(path)
            .bind(*bytes as i64)
            .bind(sha256)
            .bind(now()),
            ArchiveEnd::Empty(reason) => ended("empty", reason),
            ArchiveEnd::Failed(reason) => ended("failed", reason),
        };
        query.bind(run).bind(content).execute(&self.writer).await?;
        Ok(())
    }

    /// All tables that are owed or failed are due now.
    pub async fn release_archive(&self) -> Result<(), StoreError> {
        let release = "UPDATE archive SET state = 'owed', attempts = 0, due_at = ? WHERE state IN ('owed', 'failed')";
        sqlx::query(release).bind(now()).execute(&self.writer).await?;
        Ok(())
    }

    /// The tables of a run, for the archive.
    pub async fn archive_of(&self, run: RunId) -> Result<Vec<ArchiveRecord>, StoreError> {
        let query = sqlx::query("SELECT * FROM archive WHERE run = ? ORDER BY content").bind(run);
        query.fetch_all(&self.readers).await?.iter().map(record).collect()
    }

    pub async fn archive_counts(&self) -> Result<ArchiveCounts, StoreError> {
        let query = "SELECT COUNT(*) FILTER (WHERE state = 'owed') AS owed, \
            COUNT(*) FILTER (WHERE state = 'archived') AS archived, COUNT(*) FILTER (WHERE state = 'failed') AS failed, \
            COUNT(*) FILTER (WHERE state = 'empty') AS empty, COUNT(*) FILTER (WHERE dropped_at IS NOT NULL) AS dropped, \
            MIN(owed_at) FILTER (WHERE state = 'owed') AS oldest_owed, \
            (SELECT reason FROM archive WHERE state IN ('owed', 'failed') AND reason IS NOT NULL \
                ORDER BY state = 'owed' DESC, due_at DESC LIMIT 1) AS last_error FROM archive";
        let row = sqlx::query(query).fetch_one(&self.readers).await?;
        let count = |column: &str| row.try_get::<i64, _>(column).map(|count| count as u64);
        Ok(ArchiveCounts {
            owed: count("owed")?,
            archived: count("archived")?,
            failed: count("failed")?,
            empty: count("empty")?,
            dropped: count("dropped")?,
            oldest_owed: row.try_get("oldest_owed")?,
            last_error: row.try_get("last_error")?,
        })
    }

    /// Archived samples that the store still holds, of runs that ended before `before`; oldest first.
    pub async fn droppable_samples(&self, before: Timestamp) -> Result<Vec<ArchiveRecord>, StoreError> {
        let query = "SELECT archive.* FROM archive JOIN runs ON runs.id = archive.run \
            WHERE content = 'samples' AND archive.state = 'archived' AND dropped_at IS NULL AND finished_at < ? \
            ORDER BY finished_at, archive.run";
        let rows = sqlx::query(query).bind(format!("{before:.3}")).fetch_all(&self.readers).await?;
        rows.iter().map(record).collect()
    }

    /// Removes the samples of a run from the store. Its overview, its journal and its `result` (JSON) are kept.
    pub async fn drop_samples(&self, run: RunId, result: Option<&[u8]>) -> Result<(), StoreError> {
        let mark = "UPDATE archive SET dropped_at = ?, result = ? \
            WHERE run = ? AND content = 'samples' AND state = 'archived' AND dropped_at IS NULL";
        let mark = sqlx::query(mark).bind(now()).bind(result.map(packed).transpose()?).bind(run);
        mark.execute(&self.writer).await?;
        self.remove_dropped(run).await
    }

    /// The result of a run at the moment when its samples were dropped (JSON).
    pub async fn result_of_dropped(&self, run: RunId) -> Result<Option<Vec<u8>>, StoreError> {
        let query = "SELECT result FROM archive WHERE run = ? AND content = 'samples' AND result IS NOT NULL";
        let result: Option<Vec<u8>> = sqlx::query_scalar(query).bind(run).fetch_optional(&self.readers).await?;
        result.as_deref().map(unpacked).transpose()
    }

    /// Completes removals that the end of a daemon has interrupted.
    pub async fn complete_drops(&self) -> Result<(), StoreError> {
        let begun = "SELECT run FROM archive WHERE dropped_at IS NOT NULL \
            AND EXISTS (SELECT 1 FROM blocks WHERE blocks.run = archive.run)";
        let begun: Vec<RunId> = sqlx::query_scalar(begun).fetch_all(&self.readers).await?;
        for run in begun {
            self.remove_dropped(run).await?;
        }
        Ok(())
    }

    async fn remove_dropped(&self, run: RunId) -> Result<(), StoreError> {
        let slice = "DELETE FROM blocks WHERE id IN (SELECT id FROM blocks WHERE run = ? LIMIT ?)";
        while sqlx::query(slice).bind(run).bind(SLICE).execute(&self.writer).await?.rows_affected() > 0 {
            tokio::time::sleep(PAUSE).await;
        }
        Ok(())
    }
}

type Update<'q> = sqlx::query::Query<'q, sqlx::Sqlite, sqlx::sqlite::SqliteArguments>;

fn ended<'q>(state: &'q str, reason: &'q str) -> Update<'q> {
    let end = "UPDATE archive SET state = ?, attempts = attempts + 1, reason = ? \
        WHERE run = ? AND content = ? AND state = 'owed'";
    sqlx::query(end).bind(state).bind(reason)
}

/// [`StoreError::Dropped`] if the samples of the run are only in the archive.
pub(super) async fn refuse_dropped(reader: &mut SqliteConnection, run: RunId) -> Result<(), StoreError> {
    let dropped = "SELECT folder, path FROM archive WHERE run = ? AND content = 'samples' AND dropped_at IS NOT NULL";
    let dropped: Option<(String, String)> = sqlx::query_as(dropped).bind(run).fetch_optional(reader).await?;
    match dropped {
        Some((folder, path)) => Err(StoreError::Dropped { run, file: format!("{folder}/{path}") }),
        None => Ok(()),
    }
}

fn record(row: &SqliteRow) -> Result<ArchiveRecord, StoreError> {
    Ok(ArchiveRecord {
        run: row.try_get("run")?,
        content: row.try_get("content")?,
        state: row.try_get("state")?,
        attempts: row.try_get::<i64, _>("attempts")? as u32,
        reason: row.try_get("reason")?,
        folder: row.try_get("folder")?,
        path: row.try_get("path")?,
        bytes: row.try_get::<Option<i64>, _>("bytes")?.map(|bytes| bytes as u64),
        sha256: row.try_get("sha256")?,
        archived_at: row.try_get("archived_at")?,
        dropped_at: row.try_get("dropped_at")?,
    })
}
