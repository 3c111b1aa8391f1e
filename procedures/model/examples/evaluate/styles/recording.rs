//! A recorded run with all its truth.

use crate::made::table;
use jointbench_instrument::{Meta, RunTable};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Contribution of one cause to the response, row by row.
pub struct Part {
    pub id: &'static str,
    pub values: Vec<f64>,
}

pub struct Recording {
    pub meta: Meta,
    pub style: &'static str,
    pub columns: Vec<(&'static str, Vec<f64>)>,
    /// The response of the models of this kind, as measured.
    pub response: Vec<f64>,
    /// Causes that the model of the meta file contains.
    pub base: Vec<Part>,
    pub hidden: Vec<Part>,
    pub outside: Option<Part>,
    /// Alternative causes with their contributions in this run: several shapes of each.
    pub alternatives: Vec<Part>,
    /// Parameters with the same meaning in the library.
    pub truth: BTreeMap<String, f64>,
    /// Effects that are accepted, but not required.
    pub optional: Vec<&'static str>,
    pub facts: Map<String, Value>,
}

impl Recording {
    pub fn table(&self) -> RunTable {
        let names = self.columns.iter().map(|(name, _)| (*name).to_owned()).collect();
        table(self.meta.clone(), names, self.columns.iter().map(|(_, values)| values.clone()).collect())
    }
}

/// Ten digits, the precision of the file.
pub fn written(value: f64) -> f64 {
    format!("{value:.9e}").parse().unwrap_or(value)
}
