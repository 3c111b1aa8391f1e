//! A fit as a JSON file for exchange.

use crate::export::terms;
use crate::report::fit::Fit;
use crate::{ModelError, ModelSpec};
use serde::{Deserialize, Serialize};

const FORMAT: &str = "jointbench-model";
const VERSION: u32 = 1;

/// The complete fit, including user effects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelFile {
    /// `jointbench-model`.
    pub format: String,
    /// Version of the format, 1.
    pub version: u32,
    /// The fit with all its digits.
    pub fit: Fit,
}

impl ModelFile {
    /// A file in the format and version of this program.
    pub fn new(fit: Fit) -> Self {
        Self { format: FORMAT.to_owned(), version: VERSION, fit }
    }

    /// The file as indented JSON.
    ///
    /// # Errors
    /// [`ModelError::BadFile`] if a value cannot be written as JSON.
    pub fn to_json(&self) -> Result<String, ModelError> {
        serde_json::to_string_pretty(self).map_err(|fault| ModelError::BadFile(fault.to_string()))
    }

    /// Reads the text of [`ModelFile::to_json`]: every prediction has the same bits.
    pub fn read(text: &str) -> Result<Fit, ModelError> {
        let file: Self = serde_json::from_str(text).map_err(|fault| ModelError::BadFile(fault.to_string()))?;
        file.check()
    }

    /// The fit, if this version understands all of it.
    pub fn check(self) -> Result<Fit, ModelError> {
        if self.format != FORMAT || self.version != VERSION {
            let found = format!("format {} version {}", self.format, self.version);
            return Err(ModelError::BadFile(format!("{found}, but this program reads {FORMAT} version {VERSION}")));
        }
        let fit = self.fit;
        let spec =
            ModelSpec::with_user_effects(fit.kind, fit.effects.iter().map(String::as_str), fit.user_effects.clone())?;
        if let Some(term) = fit.terms.iter().find(|term| !spec.contains(&term.effect)) {
            return Err(ModelError::BadFile(format!("a term of {}, which is not in the model", term.effect)));
        }
        let effects = fit.effects.iter().map(|id| spec.find(id)).collect::<Result<Vec<_>, _>>()?;
        terms::check(&fit, &effects)?;
        Ok(fit)
    }
}
