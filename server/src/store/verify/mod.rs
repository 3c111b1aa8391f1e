//! Reads all stored data and reports damage by run and table, and the readable part.
//!
//! Read-only, also while a daemon uses the folder. Samples are read block by block to limit memory.

mod daily;
mod records;
mod report;
mod samples;

pub use report::{Readable, VerifyReport};

use super::keeper::{losses, missing};
use super::mark::Mark;
use super::open::{file_to_read, to_read};
use super::seal::{self, Owner, Sealed};
use super::values::now;
use super::{Store, StoreError};
use jointbench_procedure::RunId;
use records::check_rows;
use sqlx::{Connection, Row, SqliteConnection};
use std::path::Path;
use std::time::Duration;

/// Limits the number of faults that SQLite's own check lists.
const MOST_FAULTS: &str = "PRAGMA integrity_check(100)";

/// Checks the whole store in a folder.
///
/// # Errors
/// [`StoreError::NoStore`] and other errors that prevent a check. Damage is not an error.
pub async fn verify(folder: &Path) -> Result<VerifyReport, StoreError> {
    // Read before the database: a change in between must not count as a loss.
    let mark = Mark::read(folder);
    check_database(to_read(folder).await?, mark.as_ref()).await
}

/// The same for a single database file, such as a backup.
pub async fn verify_file(file: &Path) -> Result<VerifyReport, StoreError> {
    check_database(file_to_read(file).await?, None).await
}

async fn check_database(mut database: SqliteConnection, mark: Option<&Mark>) -> Result<VerifyReport, StoreError> {
    let mut report = VerifyReport { checked_at: now(), ..VerifyReport::default() };
    check_file(&mut database, &mut report).await;
    check_losses(&mut database, mark, &mut report).await;
    for sealed in of_no_run() {
        check_rows(&mut database, sealed, None, &mut report).await;
    }
    for run in run_ids(&mut database, &mut report).await {
        // In one transaction, because a daemon may write to the run.
        let mut reader = database.begin().await?;
        check_run(&mut reader, run, &mut report).await;
        reader.rollback().await?;
    }
    database.close().await?;
    Ok(report)
}

impl Store {
    /// Checks the stored data on a reader connection, one run per `pace`. Adds checksums to rows of an older release.
    /// Only [`verify`] runs SQLite's own check, because it cannot be split.
    pub async fn check(&self, pace: Duration) -> Result<VerifyReport, StoreError> {
        let mut report = VerifyReport { checked_at: now(), ..VerifyReport::default() };
        report.lost = self.losses().await?;
        for sealed in of_no_run() {
            check_rows(&mut *self.readers.acquire().await?, sealed, None, &mut report).await;
        }
        let runs = run_ids(&mut *self.readers.acquire().await?, &mut report).await;
        for run in runs {
            check_run(&mut *self.readers.begin().await?, run, &mut report).await;
            tokio::time::sleep(pace).await;
        }
        if report.without_checksum > 0 {
            self.seal_old_rows().await?;
        }
        Ok(report)
    }
}

fn of_no_run() -> impl Iterator<Item = &'static Sealed> {
    seal::ALL.into_iter().filter(|sealed| sealed.owner == Owner::Store)
}

/// Checks one run with all its records.
async fn check_run(database: &mut SqliteConnection, run: RunId, report: &mut VerifyReport) {
    report.runs += 1;
    let of_run = |sealed: &&Sealed| matches!(sealed.owner, Owner::SameRun | Owner::Run | Owner::Model);
    for sealed in seal::ALL.into_iter().filter(of_run) {
        check_rows(database, sealed, Some(run), report).await;
    }
    samples::check(database, run, report).await;
}

/// Tests id by id if SQLite cannot scan the table.
async fn run_ids(database: &mut SqliteConnection, report: &mut VerifyReport) -> Vec<RunId> {
    let ids = sqlx::query_scalar("SELECT id FROM runs ORDER BY id").fetch_all(&mut *database).await;
    match ids {
        Ok(ids) => ids,
        Err(fault) => {
            report.add(None, "runs", fault.to_string());
            let last = sqlx::query_scalar::<_, i64>("SELECT seq FROM sqlite_sequence WHERE name = 'runs'");
            (1..=last.fetch_optional(database).await.ok().flatten().unwrap_or_default()).collect()
        }
    }
}

/// SQLite's own check, including foreign keys.
async fn check_file(database: &mut SqliteConnection, report: &mut VerifyReport) {
    match sqlx::query_scalar::<_, String>(MOST_FAULTS).fetch_all(&mut *database).await {
        Ok(lines) => lines.into_iter().filter(|line| line != "ok").for_each(|line| report.add(None, "file", line)),
        Err(fault) => report.add(None, "file", fault.to_string()),
    }
    match sqlx::query("PRAGMA foreign_key_check").fetch_all(database).await {
        Ok(rows) => {
            for row in rows {
                let text = |column: &str| row.try_get::<String, _>(column).unwrap_or_default();
                let number = row.try_get::<Option<i64>, _>("rowid").ok().flatten().unwrap_or_default();
                report.add(
                    None,
                    &text("table"),
                    format!("row {number} names a row of {} that is not there", text("parent")),
                );
            }
        }
        Err(fault) => report.add(None, "file", fault.to_string()),
    }
}

/// An older release stored neither losses nor a mark; missing tables are ignored.
async fn check_losses(database: &mut SqliteConnection, mark: Option<&Mark>, report: &mut VerifyReport) {
    report.lost = losses(database).await.unwrap_or_default();
    if let Ok(Some(loss)) = missing(database, mark).await {
        report.add(None, "file", loss.to_string());
        report.lost.push(loss);
    }
}
