//! Effects: from the library, and defined by users.

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

/// A user-defined effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct EffectDefinition {
    /// Lower-case letters, digits and underscores; must differ from library ids.
    pub id: String,
    pub kind: String,
    /// `tau = …` for friction and brake, `error = …` for encoder, `torsion = …` for stiffness; the right-hand side is
    /// sufficient.
    pub formula: String,
    pub parameters: Vec<DefinedParameter>,
    #[serde(default)]
    pub title: String,
    /// One sentence for a technician.
    #[serde(default)]
    pub sentence: String,
}

/// A linear parameter is solved for; a nonlinear parameter is searched in its range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct DefinedParameter {
    pub name: String,
    /// `1` if omitted.
    #[serde(default = "one")]
    pub unit: String,
    #[serde(default)]
    pub min: Option<f64>,
    #[serde(default)]
    pub max: Option<f64>,
    /// Start values of the search, inside the bounds.
    #[serde(default)]
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub start: Option<[f64; 2]>,
    /// A whole number: all values of the range are tested.
    #[serde(default)]
    pub whole: bool,
}

fn one() -> String {
    "1".to_owned()
}
