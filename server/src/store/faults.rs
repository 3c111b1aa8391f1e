//! What was wrong with the instruments of a bench.

use super::{Store, StoreError};

impl Store {
    /// The newest faults of an instrument, newest first: when, and what.
    pub async fn faults(&self, bench: &str, instrument: &str, limit: u32) -> Result<Vec<(String, String)>, StoreError> {
        let query =
            "SELECT at, text FROM instrument_faults WHERE bench = ? AND instrument = ? ORDER BY id DESC LIMIT ?";
        Ok(sqlx::query_as(query).bind(bench).bind(instrument).bind(limit).fetch_all(&self.readers).await?)
    }

    pub async fn keep_fault(&self, bench: &str, instrument: &str, at: &str, text: &str) -> Result<(), StoreError> {
        sqlx::query("INSERT INTO instrument_faults (bench, instrument, at, text) VALUES (?, ?, ?, ?)")
            .bind(bench)
            .bind(instrument)
            .bind(at)
            .bind(text)
            .execute(&self.writer)
            .await?;
        Ok(())
    }
}
