//! Calibrations: runs whose results the next runs of a bench use.

use super::seal::CALIBRATIONS;
use super::values::now;
use super::{CalibrationRecord, Store, StoreError};
use jointbench_procedure::RunId;
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

impl Store {
    /// All entries of a bench, newest first. A damaged entry applies no run; its `by` field holds the error.
    pub async fn calibrations(&self, bench: &str) -> Result<Vec<CalibrationRecord>, StoreError> {
        let query = "SELECT * FROM calibrations WHERE bench = ? ORDER BY id DESC";
        let rows = sqlx::query(query).bind(bench).fetch_all(&self.readers).await?;
        let damaged = |row: &SqliteRow, fault: StoreError| CalibrationRecord {
            id: row.try_get("id").unwrap_or_default(),
            procedure: row.try_get("procedure").unwrap_or_default(),
            run: None,
            by: fault.to_string(),
            at: row.try_get("at").unwrap_or_default(),
        };
        Ok(rows.iter().map(|row| record(row).unwrap_or_else(|fault| damaged(row, fault))).collect())
    }

    /// The last run that was applied to a bench, or `None` if no calibration applies.
    pub async fn calibration(&self, bench: &str, procedure: &str) -> Result<Option<RunId>, StoreError> {
        let query = "SELECT * FROM calibrations WHERE bench = ? AND procedure = ? ORDER BY id DESC LIMIT 1";
        let newest = sqlx::query(query).bind(bench).bind(procedure).fetch_optional(&self.readers).await?;
        Ok(newest.as_ref().map(record).transpose()?.and_then(|newest| newest.run))
    }

    pub async fn calibrate(
        &self,
        bench: &str,
        procedure: &str,
        run: Option<RunId>,
        by: &str,
    ) -> Result<(), StoreError> {
        let at = now();
        let cells = [bench.into(), procedure.into(), run.into(), by.into(), (&at).into()];
        CALIBRATIONS.insert(&cells).execute(&self.writer).await?;
        Ok(())
    }
}

fn record(row: &SqliteRow) -> Result<CalibrationRecord, StoreError> {
    CALIBRATIONS.check(row)?;
    Ok(CalibrationRecord {
        id: row.try_get("id")?,
        procedure: row.try_get("procedure")?,
        run: row.try_get("run")?,
        by: row.try_get("who")?,
        at: row.try_get("at")?,
    })
}
