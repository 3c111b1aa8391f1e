//! The correct answer of a run.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

#[derive(Clone, Serialize, Deserialize)]
pub struct Answer {
    pub kind: String,
    /// `null`, `one`, `two`, `three` or `unknown`.
    pub category: String,
    pub style: String,
    pub hidden: Vec<String>,
    pub outside: Option<String>,
    /// For each hidden effect the ids that this data cannot distinguish from it.
    pub acceptable: BTreeMap<String, Vec<String>>,
    /// Ids that are accepted, but not required.
    pub optional: Vec<String>,
    /// If false, no effect has to be named.
    pub identifiable: bool,
    pub verdict: String,
    /// True parameters with the same meaning in the library.
    pub truth: BTreeMap<String, f64>,
    /// Size of each hidden effect in standard errors, given all other true effects.
    pub sigma: BTreeMap<String, f64>,
    pub facts: Map<String, Value>,
}

impl Answer {
    pub fn label(&self) -> String {
        match (&self.outside, self.hidden.as_slice()) {
            (Some(outside), _) => outside.clone(),
            (None, []) => "none".into(),
            (None, hidden) => hidden.join("+"),
        }
    }
}
