//! Comparison of records with their checksums.

use super::super::migrations::NEWEST;
use super::super::seal::Sealed;
use super::super::{Store, StoreError};
use super::VerifyReport;
use jointbench_procedure::RunId;
use sqlx::sqlite::SqliteRow;
use sqlx::{AssertSqlSafe, Row, SqliteConnection};
use std::time::Duration;

/// Rows that are read at a time.
const SLICE: i64 = 64;
/// Pause between two slices of rows that get their checksums: the recorder has priority on the writer.
const PAUSE: Duration = Duration::from_millis(50);

/// Checks all rows of a table, or those of a run. Checks row by row if SQLite cannot scan the table.
pub async fn check_rows(
    database: &mut SqliteConnection,
    sealed: &Sealed,
    run: Option<RunId>,
    report: &mut VerifyReport,
) {
    if is_newer_than(database, sealed.table).await {
        return;
    }
    let (mut whole, mut damaged) = (0, 0);
    for id in row_ids(database, sealed, run, report).await {
        let row = row(database, sealed, run, &id).await;
        let checked = row.and_then(|row| row.as_ref().map_or(Ok(true), |row| sealed.check(row)));
        match checked {
            Ok(has_checksum) => {
                whole += 1;
                report.without_checksum += u64::from(!has_checksum);
            }
            Err(fault) => {
                damaged += 1;
                report.add(run, sealed.table, what(&fault));
            }
        }
    }
    report.count(run, sealed, whole, damaged);
}

/// Whether a database of an earlier schema does not have the table yet.
async fn is_newer_than(database: &mut SqliteConnection, table: &str) -> bool {
    let sql = "SELECT (SELECT MAX(version) FROM _sqlx_migrations) < ? AND NOT EXISTS (SELECT 1 FROM sqlite_schema WHERE name = ?)";
    sqlx::query_scalar(sql).bind(NEWEST).bind(table).fetch_one(database).await.unwrap_or(false)
}

/// The damage without the advice.
pub fn what(fault: &StoreError) -> String {
    match fault {
        StoreError::Damaged(damage) => damage.to_string(),
        other => other.to_string(),
    }
}

async fn row_ids(
    database: &mut SqliteConnection,
    sealed: &Sealed,
    run: Option<RunId>,
    report: &mut VerifyReport,
) -> Vec<i64> {
    let (key, condition) = (sealed.key, sealed.owner.condition());
    let sql = format!("SELECT {key} FROM {} WHERE {condition} ORDER BY 1", sealed.table);
    match sqlx::query_scalar(AssertSqlSafe(sql)).bind(run).fetch_all(database).await {
        Ok(ids) => ids,
        Err(fault) => {
            report.add(run, sealed.table, fault.to_string());
            report.count(run, sealed, 0, 1);
            Vec::new()
        }
    }
}

async fn row(
    database: &mut SqliteConnection,
    sealed: &Sealed,
    run: Option<RunId>,
    id: &i64,
) -> Result<Option<SqliteRow>, StoreError> {
    let (key, condition) = (sealed.key, sealed.owner.condition());
    let sql = format!("SELECT * FROM {} WHERE {condition} AND {key} = ?2", sealed.table);
    Ok(sqlx::query(AssertSqlSafe(sql)).bind(run).bind(id).fetch_optional(database).await?)
}

impl Store {
    /// Adds checksums to rows of an older release, slice by slice. Earlier damage remains undetected.
    pub(super) async fn seal_old_rows(&self) -> Result<(), StoreError> {
        for sealed in super::seal::ALL {
            // A key within a run or an autopilot gives no order over the table: each slice is the first one.
            let key = if sealed.key == "id" { "id" } else { "0" };
            let mut behind = -1;
            while let Some(last) = self.seal_slice(sealed, key, behind).await? {
                behind = last;
                tokio::time::sleep(PAUSE).await;
            }
        }
        Ok(())
    }

    /// The key of the last row that got a checksum; `None` if all rows have one.
    async fn seal_slice(&self, sealed: &Sealed, key: &str, behind: i64) -> Result<Option<i64>, StoreError> {
        let Sealed { table, checksum, .. } = sealed;
        let sql = format!(
            "SELECT *, {key} AS slice_key FROM {table} WHERE {checksum} IS NULL AND ({key} = 0 OR {key} > ?) ORDER BY slice_key LIMIT {SLICE}"
        );
        let rows = sqlx::query(AssertSqlSafe(sql)).bind(behind).fetch_all(&self.readers).await?;
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        for row in &rows {
            let names = sealed.names.iter().map(|name| format!("{name} IS ?"));
            let these = names.collect::<Vec<_>>().join(" AND ");
            let sql = format!("UPDATE {table} SET {checksum} = ? WHERE {checksum} IS NULL AND {these}");
            let mut seal = sqlx::query(AssertSqlSafe(sql)).bind(sealed.of_row(row)?);
            for name in sealed.names {
                seal = match row.try_get::<i64, _>(*name) {
                    Ok(number) => seal.bind(number),
                    Err(_) => seal.bind(row.try_get::<String, _>(*name)?),
                };
            }
            seal.execute(&mut *writer).await?;
        }
        writer.commit().await?;
        Ok(rows.last().map(|row| row.try_get("slice_key")).transpose()?)
    }
}
