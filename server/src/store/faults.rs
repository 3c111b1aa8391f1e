//! Faults of the instruments of a bench.

use super::seal::INSTRUMENT_FAULTS;
use super::{Store, StoreError};
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

impl Store {
    /// The newest faults of an instrument, newest first: time and text. The text of a damaged fault is the error.
    pub async fn faults(&self, bench: &str, instrument: &str, limit: u32) -> Result<Vec<(String, String)>, StoreError> {
        let query = "SELECT * FROM instrument_faults WHERE bench = ? AND instrument = ? ORDER BY id DESC LIMIT ?";
        let rows = sqlx::query(query).bind(bench).bind(instrument).bind(limit).fetch_all(&self.readers).await?;
        let damaged = |row: &SqliteRow, fault: StoreError| (row.try_get("at").unwrap_or_default(), fault.to_string());
        Ok(rows.iter().map(|row| record(row).unwrap_or_else(|fault| damaged(row, fault))).collect())
    }

    pub async fn keep_fault(&self, bench: &str, instrument: &str, at: &str, text: &str) -> Result<(), StoreError> {
        let cells = [bench.into(), instrument.into(), text.into(), at.into()];
        INSTRUMENT_FAULTS.insert(&cells).execute(&self.writer).await?;
        Ok(())
    }
}

fn record(row: &SqliteRow) -> Result<(String, String), StoreError> {
    INSTRUMENT_FAULTS.check(row)?;
    Ok((row.try_get("at")?, row.try_get("text")?))
}
