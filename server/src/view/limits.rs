//! Limits on the quantities of a result.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::fmt;
use utoipa::ToSchema;

/// Outcome of a limit; of several limits the worst, which is the last of these words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum LimitOutcome {
    /// The 95 % interval is within the limits by the guard band.
    Pass,
    /// The interval crosses a limit or its guard band.
    Marginal,
    /// The result has no such quantity, or the quantity has no interval.
    Inconclusive,
    /// The whole interval exceeds a limit, or the value of a quantity without an interval.
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
    /// What would decide a limit that is marginal or inconclusive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decision: Option<LimitDecision>,
}

/// What would decide a limit. The width of an interval falls with the square root of the number of independent
/// repeats. This assumes that the whole interval is scatter between repeats, and that the value stays.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LimitDecision {
    pub by: DecidedBy,
    /// Procedure of the deciding run.
    pub procedure: String,
    /// Settings of the deciding run that differ from those of this run; empty unless `by` is `longer_run`.
    #[schema(value_type = Object)]
    pub settings: Map<String, Value>,
    /// Number of independent repeats, as a multiple of those of this run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub times: Option<f64>,
}

impl LimitDecision {
    /// More repeats are no advice.
    pub const MOST_TIMES: f64 = 100.0;
}

/// The advice for a person.
impl fmt::Display for LimitDecision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { by, procedure, settings, times } = self;
        let many = times.map(|times| format!("{:.0} times as many repeats", raised(times))).unwrap_or_default();
        match by {
            DecidedBy::LongerRun => {
                let settings: Vec<String> =
                    settings.iter().map(|(name, value)| format!("{name}={}", super::typed(value))).collect();
                write!(f, "a run of {procedure} with {} would decide if the value stays", settings.join(", "))
            }
            DecidedBy::TooManyRepeats if times.is_some_and(|times| times <= Self::MOST_TIMES) => {
                write!(f, "{many} would decide, more than one run of {procedure} permits")
            }
            DecidedBy::TooManyRepeats => f.write_str("the value is too near to the limit for any number of repeats"),
            DecidedBy::NoSetting => write!(f, "{many} would decide, but {procedure} has no setting for repeats"),
            DecidedBy::Precondition => {
                f.write_str("repeats do not help: the run found a precondition broken, and repeats have the same bias")
            }
            DecidedBy::OtherValue => f.write_str("repeats do not help: the value itself is in the guard band"),
            DecidedBy::NoInterval => {
                write!(f, "repeats do not help: {procedure} states no interval for this quantity")
            }
        }
    }
}

/// The next whole number, with a tolerance for rounding.
pub fn raised(value: f64) -> f64 {
    (value * (1.0 - 1e-9)).ceil()
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum DecidedBy {
    /// The same procedure with more repeats, or a longer duration (`settings`).
    LongerRun,
    /// `times` as many repeats, which is more than the procedure permits, or more than a hundred times as many.
    TooManyRepeats,
    /// The procedure has no setting for repeats or duration.
    NoSetting,
    /// Repeats do not help: the run found a precondition broken, so each repeat has the same bias. Correct it first.
    Precondition,
    /// Repeats do not help: the value itself is in the guard band.
    OtherValue,
    /// Repeats do not help: the procedure states no interval for this quantity.
    NoInterval,
}
