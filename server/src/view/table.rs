//! A table that is no run.

use serde::Deserialize;
use std::fmt;
use utoipa::ToSchema;

/// A table, row by row.
#[derive(Debug, Clone, PartialEq, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// Names of the columns, with their units.
    pub head: Vec<String>,
    /// Equal number of values in each row; `null` for a missing value.
    pub rows: Vec<Vec<Option<Cell>>>,
}

#[derive(Debug, Clone, PartialEq, Deserialize, ToSchema)]
#[serde(untagged)]
pub enum Cell {
    Number(f64),
    Word(String),
}

impl Cell {
    pub fn number(&self) -> Option<f64> {
        match self {
            Cell::Number(value) => Some(*value),
            Cell::Word(_) => None,
        }
    }
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Cell::Number(value) => write!(f, "{value}"),
            Cell::Word(text) => f.write_str(text),
        }
    }
}
