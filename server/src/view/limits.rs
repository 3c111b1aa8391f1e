//! Limits on the quantities of a result.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Outcome of a limit; of several limits the worst, which is the last of these words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum LimitOutcome {
    /// The 95 % interval is within the limits by the guard band.
    Pass,
    /// The value is within the limits, but its interval or the guard band is not.
    Marginal,
    /// The result has no such quantity, or the quantity has no interval.
    Inconclusive,
    /// The value exceeds a limit.
    Fail,
}

/// The limits of a run, and whether its result meets them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LimitCheck {
    /// SHA-256 of the limits file, in hexadecimal digits.
    pub sha256: String,
    /// The worst outcome.
    pub outcome: LimitOutcome,
    pub limits: Vec<LimitResult>,
}

/// One limit and its outcome. Limits and guard band are in `unit`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LimitResult {
    /// Name of the quantity.
    pub quantity: String,
    pub lower: Option<f64>,
    pub upper: Option<f64>,
    pub guard_band: f64,
    pub unit: String,
    /// The limit in words.
    pub text: String,
    pub outcome: LimitOutcome,
    /// The limit with the measured value, and what would decide.
    pub message: String,
}
