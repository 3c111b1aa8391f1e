//! Sort order of the list of runs.

use super::StoreError;
use sqlx::{QueryBuilder, Sqlite};

/// Sort keys with their column. Error and Coulomb friction are those of the listed model version.
const COLUMNS: [(&str, &str); 9] = [
    ("started", "id"),
    ("state", "state"),
    ("procedure", "procedure"),
    ("bench", "bench"),
    ("duration", "duration_s"),
    ("rows", "rows"),
    ("safe", "safe"),
    (
        "error",
        "(SELECT validation_rms FROM models_told WHERE run = runs_told.id AND NOT idle AND NOT tried ORDER BY id DESC LIMIT 1)",
    ),
    (
        "coulomb",
        "(SELECT (SELECT p.value ->> '$.value' FROM json_each(IIF(json_valid(models_told.fit), models_told.fit, '{}'), '$.parameters') AS p \
         WHERE p.value ->> '$.effect' = 'coulomb') FROM models_told WHERE run = runs_told.id AND NOT idle AND NOT tried ORDER BY id DESC LIMIT 1)",
    ),
];

/// Column, and whether the largest value is first. Missing values are last in both cases; equal values are sorted
/// newest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Order {
    column: &'static str,
    falling: bool,
}

impl Default for Order {
    /// Newest first.
    fn default() -> Self {
        Self { column: "id", falling: true }
    }
}

impl Order {
    /// `rows`, the smallest first, or `-rows`, the largest first.
    pub fn parse(text: &str) -> Result<Self, StoreError> {
        let name = text.strip_prefix('-').unwrap_or(text);
        match COLUMNS.iter().find(|(known, _)| *known == name) {
            Some((_, column)) => Ok(Self { column, falling: text.len() > name.len() }),
            None => Err(StoreError::Order { name: name.to_owned(), known: COLUMNS.map(|(known, _)| known).join(", ") }),
        }
    }

    /// ` ORDER BY …`
    pub fn push(&self, query: &mut QueryBuilder<Sqlite>) {
        query.push(" ORDER BY ").push(self.column);
        query.push(if self.falling { " DESC NULLS LAST, id DESC" } else { " ASC NULLS LAST, id DESC" });
    }
}
