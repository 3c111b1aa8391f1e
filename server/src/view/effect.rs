//! Effects: from the library, and defined by users.

use super::EffectDefinition;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// One physical effect that a model can contain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Effect {
    pub id: String,
    pub kind: String,
    pub title: String,
    /// One sentence for a technician.
    pub sentence: String,
    pub formula: String,
    /// Published source.
    #[serde(default)]
    pub source: String,
    /// Shape of the residual if the effect is missing.
    #[serde(default)]
    pub looks: String,
    pub parameters: Vec<EffectParameter>,
    /// Columns required for the effect.
    pub needs: Vec<String>,
    /// User definition; `null` for a library effect.
    #[serde(default)]
    pub definition: Option<EffectDefinition>,
    /// Version of the user definition, from 1.
    #[serde(default)]
    pub version: Option<i64>,
    /// Runs whose diagnosis may suggest this user-defined effect; empty for a library effect, which every run uses.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub runs: Vec<i64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct EffectParameter {
    pub name: String,
    pub unit: String,
    pub min: Option<f64>,
    pub max: Option<f64>,
}
