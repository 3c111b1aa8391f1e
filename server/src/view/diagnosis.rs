//! Where a model version fails and what it lacks.

use super::{Fit, FittedParameter, ResidualKind};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

/// Which model version to diagnose.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({"model": 1}))]
pub struct NewDiagnosis {
    pub model: i64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// No further effect is detectable in this data.
    Adequate,
    /// An effect of the library explains the residual structure.
    MissingEffect,
    /// Residual structure that no effect of the library explains.
    UnexplainedStructure,
}

/// Evidence that an effect is missing, and its significance.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    #[default]
    Strong,
    /// Significant, but less than 5 % of the validation error.
    Small,
    /// Weak: p-value above 1 %, or an interval that includes zero.
    Weak,
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

/// What `jointbench diagnose --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Finding {
    pub kind: String,
    /// Effects of the diagnosed model.
    pub model: Vec<String>,
    pub fit: Fit,
    pub residual: ResidualKind,
    /// Of the same kind as the RMS figures; `null` without repeats.
    pub noise_floor_rms: Option<f64>,
    pub noise_floor: NoiseFloor,
    pub verdict: Verdict,
    /// One sentence.
    pub summary: String,
    /// The summary with its effects as separate parts; empty in a diagnosis of an older version.
    #[serde(default)]
    #[schema(required = true)]
    pub summary_parts: Vec<TextPart>,
    /// Contradictions between columns, each as a sentence. The summary begins with them.
    #[serde(default)]
    #[schema(required = true)]
    pub data_problems: Vec<String>,
    /// Why no verdict is possible: the data cannot show a missing effect, or the columns contradict each other.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undecided: Option<String>,
    /// The kind of that reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undecided_reason: Option<UndecidedReason>,
    /// Regions with significant residual, largest first.
    #[serde(rename = "where")]
    pub regions: Vec<Region>,
    /// Whether unexplained structure remains with all suggestions; no run is then recommended for untestable effects.
    #[serde(default)]
    pub structure_remains: bool,
    /// Ranked; empty unless the verdict is `missing_effect`.
    pub suggestions: Vec<Suggestion>,
    /// Recommended next run.
    pub experiment: Option<Experiment>,
    /// Effects that were tested and are not significant, each with an upper limit.
    pub silent: Vec<Silent>,
    /// Effects that are not testable with this data, also because their detection limit exceeds 5 % of the signal.
    pub not_visible: Vec<Invisible>,
    /// Rejected effects.
    #[serde(default)]
    pub left_out: Vec<LeftOut>,
}

/// A part of a text.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TextPart {
    Text(String),
    /// Id of an effect.
    Effect(String),
}

/// Why no verdict is possible.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum UndecidedReason {
    /// The columns contradict each other.
    ContradictoryColumns,
    /// Too few independent blocks to name an effect.
    TooFewBlocks,
    /// The repeatability of the run is not known.
    NoNoiseFloor,
    /// The validation error is far above the noise floor, and no effect or function of one axis explains it.
    AboveNoiseFloor,
    /// A parameter contradicts physics in every model.
    ImpossibleParameter,
}

/// Repeatability of the measurement (noise floor).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NoiseFloor {
    pub rms: Option<f64>,
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub ci95: Option<[f64; 2]>,
    /// Origin of the figure.
    pub source: String,
    /// Fraction of the remaining squared error that is equal in all repeats.
    pub repeatable_share: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Region {
    pub axis: String,
    pub from: f64,
    pub to: f64,
    pub mean_residual: f64,
    /// Simultaneous over all regions of all maps.
    #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
    pub ci95: [f64; 2],
    pub samples: u64,
    /// `positive` or `negative` motion; absent for both.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<String>,
    /// The same as one sentence.
    pub sentence: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Suggestion {
    pub effect: String,
    /// With the effect added.
    pub validation_rms: f64,
    /// RMS error of the effects alone on the fitted data; absent for a fit without nuisance terms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effects_rms: Option<f64>,
    /// Relative reduction of the validation error by this effect alone.
    pub error_reduction: f64,
    /// From the scatter over the validation data; absent for an effect that acts outside the data of the RMS.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub error_reduction_ci95: Option<[f64; 2]>,
    /// Change of the Bayesian information criterion over independent blocks; negative values favour the effect.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bic_change: Option<f64>,
    /// Relative reduction of the validation error together with all other suggestions.
    #[serde(default)]
    pub error_reduction_together: f64,
    /// Family-wise p-value from sign flips of blocks.
    pub p_value: f64,
    #[serde(default)]
    #[schema(required = true)]
    pub evidence: Evidence,
    /// No sign flip scored as high: the p-value is at most `p_value`.
    #[serde(default)]
    pub p_at_most: bool,
    pub parameters: Vec<FittedParameter>,
    /// Effects that this data cannot distinguish from it.
    pub confounded_with: Vec<String>,
    /// What the effect is, and the reasons.
    pub why: String,
    /// Its evidence and the effects that this data cannot distinguish from it; empty in a diagnosis of an older version.
    #[serde(default)]
    #[schema(required = true)]
    pub reasons: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Experiment {
    pub procedure: String,
    #[schema(value_type = Object)]
    pub parameters: Map<String, Value>,
    pub why: String,
    /// Expected separation of the candidate effects, in standard deviations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected_z: Option<f64>,
    /// Maximum bench time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected_duration_s: Option<f64>,
    /// Effects that the run distinguishes or makes testable.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub separates: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Silent {
    pub effect: String,
    /// Detection limit: RMS of the smallest effect that is found with 80 % power.
    pub minimum_detectable_rms: f64,
    /// The effect is smaller than this RMS (95 %).
    pub upper_rms: f64,
    /// Search range, if limited.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sought: Option<String>,
}

/// A rejected effect: tested, but not added to the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LeftOut {
    pub effect: String,
    /// Results of older releases have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<RejectionReason>,
    /// The reason in words, with the figures.
    pub why: String,
}

/// Why an effect was tested and rejected.
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
    /// Its size is known, and with it the error is not smaller.
    NoReduction,
    /// Removed again: the model fits equally well without it.
    Redundant,
    /// Removed again: its size would be physically impossible.
    Infeasible,
    /// Removed again: with it, a coefficient of the given model would be negative.
    MutuallyCancelling,
    /// Removed again: it adds nothing to the other effects.
    Insignificant,
    /// Removed again: another effect predicts better in its place.
    Swapped,
    /// Removed again: a zero that drifts over time explains as much.
    RandomWalk,
    /// Removed again: this run does not determine its size.
    Unidentified,
    /// Removed again: it explains only part of the structure over its axis.
    PartialExplanation,
    /// Removed again: it explains nothing beyond the remaining structure.
    Spurious,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Invisible {
    pub effect: String,
    /// Results of older releases have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<InvisibleReason>,
    /// The reason in words: the missing signal or excitation.
    pub why: String,
}

/// Why data cannot show an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum InvisibleReason {
    /// The run lacks a signal or an excitation that the effect needs.
    NotExcited,
    /// In this data it is indistinguishable from effects of the model.
    Confounded,
    /// It acts on ramps only, which are tested for a delay only.
    RampsOnly,
    /// Its detection limit exceeds a share of the measured signal.
    DetectionLimit,
}

#[cfg(test)]
mod tests {
    use super::RejectionReason as View;
    use crate::view::reread;
    use jointbench_model::{RejectionReason as Model, RemovalReason as Removal};

    /// A new reason of the model does not compile here until the view has it too.
    fn viewed(reason: Model) -> View {
        match reason {
            Model::Confounded => View::Confounded,
            Model::NotSignificant => View::NotSignificant,
            Model::FewBlocks => View::FewBlocks,
            Model::FormError => View::FormError,
            Model::ModelFull => View::ModelFull,
            Model::NoReduction => View::NoReduction,
            Model::Removed(Removal::Redundant) => View::Redundant,
            Model::Removed(Removal::Infeasible) => View::Infeasible,
            Model::Removed(Removal::MutuallyCancelling) => View::MutuallyCancelling,
            Model::Removed(Removal::Insignificant) => View::Insignificant,
            Model::Removed(Removal::Swapped) => View::Swapped,
            Model::Removed(Removal::RandomWalk) => View::RandomWalk,
            Model::Removed(Removal::Unidentified) => View::Unidentified,
            Model::Removed(Removal::PartialExplanation) => View::PartialExplanation,
            Model::Removed(Removal::Spurious) => View::Spurious,
        }
    }

    #[test]
    fn each_reason_of_the_model_is_one_of_the_view() {
        let removals = [
            Removal::Redundant,
            Removal::Infeasible,
            Removal::MutuallyCancelling,
            Removal::Insignificant,
            Removal::Swapped,
            Removal::RandomWalk,
            Removal::Unidentified,
            Removal::PartialExplanation,
            Removal::Spurious,
        ];
        let others = [
            Model::Confounded,
            Model::NotSignificant,
            Model::FewBlocks,
            Model::FormError,
            Model::ModelFull,
            Model::NoReduction,
        ];
        for reason in removals.map(Model::Removed).into_iter().chain(others) {
            assert_eq!(reread::<_, View>(&reason).expect("a reason of the view"), viewed(reason));
        }
    }
}
