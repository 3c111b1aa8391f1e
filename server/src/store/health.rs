//! Damage and losses of the store.

use super::keeper::Loss;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Result of the latest integrity check of the store.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
pub struct StoreHealth {
    /// `null` until the first check is complete; one check per day.
    #[schema(format = DateTime)]
    pub checked_at: Option<String>,
    pub damaged: Vec<DamagedRecord>,
    /// Acknowledged changes that were missing when the store was opened.
    pub lost: Vec<Loss>,
}

/// One damaged record.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct DamagedRecord {
    pub run: Option<i64>,
    /// `file` if found by the integrity check of SQLite.
    pub table: String,
    pub what: String,
}
