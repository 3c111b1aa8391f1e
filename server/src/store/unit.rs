//! A unit under test.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A unit under test. The serial number identifies it.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Unit {
    /// At most 80 characters, as every text of a unit.
    #[serde(default)]
    #[schema(required = true)]
    pub serial: String,
    /// Part number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// Revision of the part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub revision: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub batch: Option<String>,
}

impl Unit {
    /// For a line of text: `SN123, part P, revision B, batch 7`.
    pub fn line(&self) -> String {
        let named = [("part", &self.part), ("revision", &self.revision), ("batch", &self.batch)];
        let named = named.iter().filter_map(|(name, text)| Some(format!(", {name} {}", text.as_ref()?)));
        std::iter::once(self.serial.clone()).chain(named).collect()
    }
}
