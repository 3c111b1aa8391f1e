//! What is asked: a model as a kind plus a set of effects, and how to go about it.

use crate::{ModelError, effects};
use jointbench_instrument::{Kind, RunTable};
use serde::{Deserialize, Serialize};

/// A model: a kind and the effects that it is the sum of.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModelSpec {
    pub kind: Kind,
    /// Stable effect ids, in the order in which they were added.
    pub effects: Vec<String>,
}

impl ModelSpec {
    /// Checks that every effect is known for the kind and named once.
    pub fn new(kind: Kind, effects: impl IntoIterator<Item = impl Into<String>>) -> Result<Self, ModelError> {
        let effects: Vec<String> = effects.into_iter().map(Into::into).collect();
        if effects.is_empty() {
            return Err(ModelError::EmptyModel);
        }
        for (i, id) in effects.iter().enumerate() {
            effects::find(kind, id)?;
            if effects[..i].contains(id) {
                return Err(ModelError::TwiceNamed(id.clone()));
            }
        }
        Ok(Self { kind, effects })
    }

    /// The `baseline` of the run's meta file.
    pub fn baseline(run: &RunTable) -> Result<Self, ModelError> {
        Self::new(run.kind(), run.meta().baseline.iter())
    }

    /// Effects separated by commas, as the command line gives them.
    pub fn parse(kind: Kind, list: &str) -> Result<Self, ModelError> {
        Self::new(kind, list.split(',').map(str::trim).filter(|id| !id.is_empty()))
    }

    pub fn contains(&self, id: &str) -> bool {
        self.effects.iter().any(|e| e == id)
    }

    pub fn with(&self, id: &str) -> Result<Self, ModelError> {
        Self::new(self.kind, self.effects.iter().map(String::as_str).chain([id]))
    }

    pub fn without(&self, id: &str) -> Self {
        Self { kind: self.kind, effects: self.effects.iter().filter(|e| *e != id).cloned().collect() }
    }
}

/// How to prepare a run and how sure to be. Every default is chosen from the data where it is `None`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// What the residual is made of. `None`: plateau means where the run has plateaus, filtered samples else.
    pub residual: Option<crate::ResidualKind>,
    /// Corner of the zero-phase Butterworth filter, 4th order, on positions [Hz].
    pub cutoff_hz: Option<f64>,
    /// One row is kept of so many samples, after a zero-phase Chebyshev filter.
    pub decimation: Option<usize>,
    /// Length of the chunks that plateaus are averaged over [s].
    pub chunk_s: Option<f64>,
    /// Family-wise error over everything that is shown.
    pub alpha: f64,
    /// The smallest share of the remaining squared error that is worth a name.
    pub practical_share: f64,
    /// Sign flips for the error control.
    pub flips: usize,
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            residual: None,
            cutoff_hz: None,
            decimation: None,
            chunk_s: None,
            alpha: 0.05,
            practical_share: 0.02,
            flips: 499,
            seed: 1,
        }
    }
}
