//! Whose result the next runs of a bench use.

use super::runs::now;
use super::{CalibrationRecord, Store, StoreError};
use jointbench_procedure::RunId;

type Row = (i64, String, Option<RunId>, String, String);

impl Store {
    /// The newest entries of a bench, newest first.
    pub async fn calibrations(&self, bench: &str, limit: u32) -> Result<Vec<CalibrationRecord>, StoreError> {
        let query = "SELECT id, procedure, run, who, at FROM calibrations WHERE bench = ? ORDER BY id DESC LIMIT ?";
        let rows: Vec<Row> = sqlx::query_as(query).bind(bench).bind(limit).fetch_all(&self.readers).await?;
        let record = |(id, procedure, run, by, at)| CalibrationRecord { id, procedure, run, by, at };
        Ok(rows.into_iter().map(record).collect())
    }

    /// The run that was applied to a bench last, where that holds.
    pub async fn calibration(&self, bench: &str, procedure: &str) -> Result<Option<RunId>, StoreError> {
        let query = "SELECT run FROM calibrations WHERE bench = ? AND procedure = ? ORDER BY id DESC LIMIT 1";
        let newest: Option<(Option<RunId>,)> =
            sqlx::query_as(query).bind(bench).bind(procedure).fetch_optional(&self.readers).await?;
        Ok(newest.and_then(|(run,)| run))
    }

    pub async fn calibrate(
        &self,
        bench: &str,
        procedure: &str,
        run: Option<RunId>,
        by: &str,
    ) -> Result<(), StoreError> {
        sqlx::query("INSERT INTO calibrations (bench, procedure, run, who, at) VALUES (?, ?, ?, ?, ?)")
            .bind(bench)
            .bind(procedure)
            .bind(run)
            .bind(by)
            .bind(now())
            .execute(&self.writer)
            .await?;
        Ok(())
    }
}
