//! Typed reasons: why an effect was added, removed, rejected, or cannot be shown.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A rejected effect, which may nevertheless be present.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LeftOut {
    /// Id of the effect.
    pub effect: String,
    /// Why it was rejected.
    pub reason: LeftOutReason,
    /// The same in words, with the figures.
    pub why: String,
}

/// Why an effect was tested and rejected: it was not added, or removed again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(untagged)]
pub enum LeftOutReason {
    /// It was not added.
    Rejected(RejectionReason),
    /// It was added and removed again.
    Removed(RemovalReason),
}

/// Why an effect was not added.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum RejectionReason {
    /// An effect of the model explains the same.
    Confounded,
    /// It would reduce the validation error, but not significantly.
    NotSignificant,
    /// It would reduce the validation error in a few blocks only.
    FewBlocks,
    /// Form error of the model may explain the same.
    FormError,
    /// The model has the largest number of added effects.
    ModelFull,
    /// With it, the error is not smaller.
    NoReduction,
    /// It acts within the shortest displacement that the run resolves.
    Unresolved,
    /// Its size is physically impossible.
    Implausible,
}

/// An effect that this data cannot show.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Invisible {
    /// Id of the effect.
    pub effect: String,
    /// Why this data cannot show it.
    pub reason: InvisibleReason,
    /// The same in words: the missing signal or excitation.
    pub why: String,
}

impl Invisible {
    pub(crate) fn not_excited(effect: &str, why: String) -> Self {
        Self { effect: effect.into(), reason: InvisibleReason::NotExcited, why }
    }
}

/// Why data cannot show an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum InvisibleReason {
    /// The run lacks a signal or an excitation that the effect needs.
    NotExcited,
    /// In this data it has the shape of effects of the model.
    Confounded,
    /// It acts on ramps only, which are tested for a delay only.
    RampsOnly,
    /// Its detection limit exceeds a fraction of the measured signal.
    DetectionLimit,
}

/// Why an effect was added.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AdditionReason {
    /// It reduces the validation error most.
    ErrorReduction,
    /// A given effect had absorbed it: the model with both predicts better.
    Masked,
    /// It predicts better in the place of an effect that was removed.
    Exchange,
    /// Without it, coefficients of the model are biased.
    OmittedVariableBias,
    /// Its size is known, and with it the error is smaller.
    KnownSize,
    /// It explains the residual on ramps.
    Ramps,
    /// It explains the residual around reversals.
    Reversals,
}

/// Why an added effect was removed again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum RemovalReason {
    /// The fitted error is as small without it.
    Redundant,
    /// Its coefficients are physically impossible.
    Infeasible,
    /// With it, a coefficient of the given model is negative.
    MutuallyCancelling,
    /// The others predict equally well without it.
    Insignificant,
    /// Another effect predicts better in its place.
    Swapped,
    /// A random-walk offset explains as much.
    RandomWalk,
    /// The run does not determine its size or shape.
    Unidentified,
    /// It explains only a part of the structure over its own axis.
    PartialExplanation,
    /// Together with a free function of the axis with structure it explains nothing.
    Spurious,
}

impl RemovalReason {
    /// The reason in a sentence about the effect.
    pub fn words(self) -> &'static str {
        match self {
            RemovalReason::Redundant => "the model fits equally well without it",
            RemovalReason::Infeasible => "its size would be physically impossible",
            RemovalReason::MutuallyCancelling => "with it, a coefficient of the given model would be negative",
            RemovalReason::Insignificant => "it adds nothing to the other effects",
            RemovalReason::Swapped => "another effect predicts better in its place",
            RemovalReason::RandomWalk => "a zero that drifts over time explains as much",
            RemovalReason::Unidentified => "this run does not determine its size or shape well enough",
            RemovalReason::PartialExplanation => "it explains only part of the structure over its axis",
            RemovalReason::Spurious => "it explains nothing beyond the remaining structure",
        }
    }
}
