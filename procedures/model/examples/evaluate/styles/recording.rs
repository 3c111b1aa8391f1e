//! A recorded run beside everything that is true about it.

use crate::made::table;
use jointbench_instrument::{Meta, RunTable};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// What one cause adds to the response, row by row.
pub struct Part {
    pub id: &'static str,
    pub values: Vec<f64>,
}

pub struct Recording {
    pub meta: Meta,
    pub style: &'static str,
    pub columns: Vec<(&'static str, Vec<f64>)>,
    /// What a model of this kind predicts, as it was measured.
    pub response: Vec<f64>,
    /// Causes that the model of the meta file holds.
    pub base: Vec<Part>,
    pub hidden: Vec<Part>,
    pub outside: Option<Part>,
    /// Other causes as they would look in this run: several shapes of each.
    pub rivals: Vec<Part>,
    /// Parameters that mean the same in the library.
    pub truth: BTreeMap<String, f64>,
    /// Effects that do no harm.
    pub optional: Vec<&'static str>,
    pub facts: Map<String, Value>,
}

impl Recording {
    pub fn table(&self) -> RunTable {
        let names = self.columns.iter().map(|(name, _)| (*name).to_owned()).collect();
        table(self.meta.clone(), names, self.columns.iter().map(|(_, values)| values.clone()).collect())
    }
}

/// Ten digits: what a file holds.
pub fn written(value: f64) -> f64 {
    format!("{value:.9e}").parse().unwrap_or(value)
}
