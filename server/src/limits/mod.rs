//! Limits on the quantities of a result: files with the limits of parts and revisions, and the one-line form of scripts.
//!
//! The text of a limits file is kept with its run. The result is compared with it at each request.

mod decision;
mod file;
mod junit;
mod requirement;

pub use decision::Made;
use file::applicable;
pub use file::{Measured, checked};
pub use junit::{Case, CaseOutcome, cases_of, junit, limit_case, run_case, skipped_case};
#[cfg(test)]
pub(crate) use requirement::tests::found;
pub use requirement::{Outcome, Requirement};

use crate::view::{LimitCheck, LimitResult, Run, Shown};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};

/// Key in the provenance of a run.
pub const ACCEPTANCE_LIMITS: &str = "acceptance_limits";

/// A limits file as it is kept with a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LimitsFile {
    pub sha256: String,
    pub text: String,
}

impl LimitsFile {
    pub fn of(text: &str) -> Self {
        let sha256 = Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect();
        Self { sha256, text: text.to_owned() }
    }

    /// From the provenance of a run. `None` for a run without limits. A file that cannot be read is an error, because the
    /// run would pass without it.
    pub fn kept(provenance: &Map<String, Value>) -> Result<Option<Self>, String> {
        let kept = provenance.get(ACCEPTANCE_LIMITS).cloned().map(serde_json::from_value);
        kept.transpose().map_err(|fault| format!("the limits that were kept with the run cannot be read: {fault}"))
    }

    /// The limits of the file that apply, compared with a result.
    pub fn check(
        &self,
        measured: &Measured,
        parameters: &Map<String, Value>,
        result: &Shown,
    ) -> Result<LimitCheck, String> {
        let made = Made { procedure: measured.procedure, parameters };
        let limits: Vec<LimitResult> =
            applicable(&self.text, measured)?.into_iter().map(|limit| limit.outcome(made, result)).collect();
        let outcomes = limits.iter().map(|limit| limit.outcome);
        let outcome = outcomes.max().ok_or("the file has no limits")?;
        Ok(LimitCheck { sha256: self.sha256.clone(), outcome, limits })
    }
}

/// The limits that are kept with a run and apply to it.
pub fn of_run(run: &Run) -> Result<Vec<Requirement>, String> {
    let Some(file) = LimitsFile::kept(&run.provenance)? else { return Ok(Vec::new()) };
    applicable(&file.text, &Measured::new(run.summary.unit.as_ref(), &run.summary.procedure))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn limits_that_cannot_be_read_are_an_error() {
        let kept = |limits: Value| LimitsFile::kept(&Map::from_iter([(ACCEPTANCE_LIMITS.to_owned(), limits)]));
        let file = LimitsFile::of("[[limit]]");
        assert_eq!(kept(json!(file)), Ok(Some(file)));
        assert!(kept(json!("[[limit]]")).unwrap_err().contains("cannot be read"));
        assert_eq!(LimitsFile::kept(&Map::new()), Ok(None));
    }
}
