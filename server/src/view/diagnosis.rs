//! Kept diagnoses of model versions.

use super::Finding;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Which model version to diagnose.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({"model": 1}))]
pub struct NewDiagnosis {
    pub model: i64,
}

/// A kept diagnosis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Diagnosis {
    pub id: i64,
    /// The model version that was diagnosed.
    pub model_id: i64,
    pub run: i64,
    #[schema(format = DateTime)]
    pub created_at: String,
    #[serde(flatten)]
    pub finding: Finding,
}
