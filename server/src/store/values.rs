//! Values of the database: times, words and JSON.

use super::StoreError;
use jiff::Timestamp;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

/// The current time in the format of the store.
pub(super) fn now() -> String {
    format!("{:.3}", Timestamp::now())
}

/// Parses a word of the store (`"safe_verified"`).
pub(super) fn word<T: DeserializeOwned>(text: &str) -> Result<T, StoreError> {
    Ok(serde_json::from_value(Value::from(text))?)
}

/// The word of the store for a value without fields.
pub(super) fn text(value: impl Serialize) -> Result<String, StoreError> {
    Ok(serde_json::from_value(serde_json::to_value(value)?)?)
}

/// A column that holds JSON.
pub(super) fn json<T: DeserializeOwned>(row: &SqliteRow, column: &str) -> Result<T, StoreError> {
    serde_json::from_str(row.try_get(column)?).map_err(|fault| StoreError::damaged(format!("column {column}: {fault}")))
}
