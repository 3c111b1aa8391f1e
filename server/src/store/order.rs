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
    ("coulomb", COULOMB),
];

const COULOMB: &str = "(SELECT (SELECT p.value ->> '$.value' FROM json_each(IIF(json_valid(models_told.fit), models_told.fit, '{}'), '$.parameters') AS p \
     WHERE p.value ->> '$.effect' = 'coulomb') FROM models_told WHERE run = runs_told.id AND NOT idle AND NOT tried ORDER BY id DESC LIMIT 1)";

/// Prefix of a quantity that a procedure has identified: `quantity:tau_c`.
const QUANTITY: &str = "quantity:";
/// The quantity that an imported run has from its model, as in the list.
const OF_MODEL: &str = "tau_c";

#[derive(Debug, Clone, PartialEq, Eq)]
enum Key {
    Column(&'static str),
    /// The name of a quantity; a look-up in the primary key for each run.
    Quantity(String),
}

/// Column, and whether the largest value is first. Missing values are last in both cases; equal values are sorted
/// newest first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Order {
    key: Key,
    falling: bool,
}

impl Default for Order {
    /// Newest first.
    fn default() -> Self {
        Self { key: Key::Column("id"), falling: true }
    }
}

impl Order {
    /// `rows`, the smallest first, or `-rows`, the largest first.
    pub fn parse(text: &str) -> Result<Self, StoreError> {
        let name = text.strip_prefix('-').unwrap_or(text);
        let falling = text.len() > name.len();
        if let Some(quantity) = name.strip_prefix(QUANTITY).filter(|quantity| !quantity.is_empty()) {
            return Ok(Self { key: Key::Quantity(quantity.to_owned()), falling });
        }
        match COLUMNS.iter().find(|(known, _)| *known == name) {
            Some((_, column)) => Ok(Self { key: Key::Column(column), falling }),
            None => Err(StoreError::Order {
                name: name.to_owned(),
                known: format!("{}, {QUANTITY}NAME", COLUMNS.map(|(known, _)| known).join(", ")),
            }),
        }
    }

    /// ` ORDER BY …`
    pub fn push(&self, query: &mut QueryBuilder<Sqlite>) {
        query.push(" ORDER BY ");
        match &self.key {
            Key::Column(column) => drop(query.push(column)),
            Key::Quantity(name) => {
                query.push("COALESCE((SELECT value FROM run_quantities WHERE run = runs_told.id AND name = ");
                query.push_bind(name.clone()).push("), ");
                match name.as_str() {
                    OF_MODEL => query.push("IIF(procedure = 'import', ").push(COULOMB).push(", NULL))"),
                    _ => query.push("NULL)"),
                };
            }
        }
        query.push(if self.falling { " DESC NULLS LAST, id DESC" } else { " ASC NULLS LAST, id DESC" });
    }
}
