//! Result of a diagnosis: missing effects and unexplained structure.

use crate::report::fit::{Fit, Parameter, ResidualKind};
use crate::report::maps::{PairMap, Region};
use crate::report::reasons::{AdditionReason, Invisible, LeftOut, RemovalReason};
use crate::report::text::TextPart;
use crate::thresholds::{MASKED_RATIO, SMALL_REDUCTION, STRONG_P_VALUE};
use crate::{Definition, UserEffect};
use jointbench_instrument::Kind;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Why a verdict is undecided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum UndecidedReason {
    /// The columns of the run contradict each other.
    ContradictoryColumns,
    /// Too few independent blocks for a significance test.
    TooFewBlocks,
    /// The noise floor is not known.
    NoNoiseFloor,
    /// The validation error is far above the noise floor, and no effect or function of one axis explains it.
    AboveNoiseFloor,
    /// A parameter is physically impossible in every model.
    ImpossibleParameter,
    /// Without the nuisance terms, the effects of the model predict worse than no model.
    NuisanceTerms,
}

/// Conclusion of a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// No repeatable structure remains that the library or the maps could show.
    Adequate,
    /// At least one effect of the library is missing.
    MissingEffect,
    /// Structure remains that no effect of the library explains.
    UnexplainedStructure,
}

/// Result of `diagnose`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Finding)]
pub struct Diagnosis {
    /// Kind of the run and the model.
    #[schema(value_type = String)]
    pub kind: Kind,
    /// Effect ids of the diagnosed model, without suggestions.
    pub model: Vec<String>,
    /// User effects that the diagnosis included.
    #[serde(default, rename = "own", skip_serializing_if = "Vec::is_empty")]
    #[schema(value_type = Vec<Definition>)]
    pub user_effects: Vec<UserEffect>,
    /// The diagnosed model, fitted to the run without suggestions.
    pub fit: Fit,
    /// Data that the residual and all RMS figures refer to.
    pub residual: ResidualKind,
    /// Noise floor of the run, comparable with the RMS figures. Absent without repeats.
    pub noise_floor_rms: Option<f64>,
    /// The noise floor with its interval and source.
    pub noise_floor: NoiseFloor,
    /// The conclusion; also read `undecided`.
    pub verdict: Verdict,
    /// Why the verdict is undecided: too little data to reject the model, so that `adequate` only means that nothing
    /// was found, or contradicting columns. `jointbench` then ends with code 3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undecided: Option<String>,
    /// The category of that reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undecided_reason: Option<UndecidedReason>,
    /// One plain sentence.
    pub summary: String,
    /// The summary with its effects as separate parts.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub summary_parts: Vec<TextPart>,
    /// Contradicting columns, each in a sentence. The summary begins with them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub data_problems: Vec<String>,
    /// Regions with a significant residual, the worst first.
    #[serde(rename = "where")]
    pub regions: Vec<Region>,
    /// The residual over the two axes with most structure, for the verdict `unexplained_structure`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub structure: Option<PairMap>,
    /// The columns with most structure, as named in the summary. Empty without structure.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shows_over: Vec<String>,
    /// Whether structure remains with all suggestions.
    #[serde(default)]
    pub structure_remains: bool,
    /// Missing effects: in the order of addition where samples are judged, elsewhere the most important first. Empty unless
    /// the verdict is `missing_effect`.
    pub suggestions: Vec<Suggestion>,
    /// An effect that may be present in addition to the suggestions and changes the parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imitated: Option<Imitated>,
    /// The recommended next run. Without a menu (`next_run`) only missing repeats are recommended, otherwise it is absent.
    pub experiment: Option<Experiment>,
    /// Effects that were tested and not found, with their detection limits.
    pub silent: Vec<Silent>,
    /// Effects that this data cannot show.
    pub not_visible: Vec<Invisible>,
    /// Effects that were tested and rejected.
    #[serde(default)]
    pub left_out: Vec<LeftOut>,
}

/// Noise floor: the repeatability of the measurement.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NoiseFloor {
    /// RMS of the pure error, in the unit of the fit. Absent if fewer than eight pairs of rows are replicates.
    pub rms: Option<f64>,
    /// 95 % interval of `rms`, jackknife over blocks. Absent if a few blocks contain all the noise.
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub ci95: Option<[f64; 2]>,
    /// Source of the figure, in words.
    pub source: String,
    /// Fraction of the remaining squared error that is repeatable.
    pub repeatable_share: Option<f64>,
    /// 95 % interval of that fraction. If it includes zero, the fraction is not significant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub repeatable_ci95: Option<[f64; 2]>,
}

/// How significant and how relevant a missing effect is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    /// Significant, with a reduction of the validation error of at least the threshold `SMALL_REDUCTION`.
    #[default]
    Strong,
    /// Significant, with a smaller reduction.
    Small,
    /// Possibly missing: its p-value exceeds the threshold `STRONG_P_VALUE`, the interval of its reduction of the
    /// validation error includes zero, the error is not smaller with it, or the intervals of all its coefficients
    /// include zero.
    Weak,
}

impl Evidence {
    /// From the figures of a suggestion; weak evidence with its reason.
    pub fn of(
        p_value: f64,
        alone: f64,
        ci95: Option<[f64; 2]>,
        together: f64,
        has_size: bool,
    ) -> (Self, Option<String>) {
        // Effects that mask each other have a small individual reduction.
        let may_be_nothing = together <= MASKED_RATIO * alone && ci95.is_some_and(|[low, _]| low <= 0.0);
        let most = alone.max(together);
        let weak = |why: &str| (Self::Weak, Some(why.to_owned()));
        match () {
            () if p_value > STRONG_P_VALUE => weak(&format!("p exceeds {STRONG_P_VALUE}")),
            () if most <= 0.0 => weak("the error is not smaller with it"),
            () if may_be_nothing => weak("the interval of the error reduction includes zero"),
            () if !has_size => weak("the intervals of all its coefficients include zero"),
            () if most < SMALL_REDUCTION => (Self::Small, None),
            () => (Self::Strong, None),
        }
    }
}

/// One missing effect with its evidence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Suggestion {
    /// Id of the missing effect.
    pub effect: String,
    /// Validation error of the model with this effect.
    pub validation_rms: f64,
    /// RMS error of the effects alone on the fitted data. Absent for a fit without nuisance terms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effects_rms: Option<f64>,
    /// 1 − validation_rms / validation_rms of the present model.
    pub error_reduction: f64,
    /// 95 % interval from the scatter over the folds. Absent for an effect of other data than that of the RMS.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub error_reduction_ci95: Option<[f64; 2]>,
    /// Change of the Bayesian information criterion by this effect in the complete model, counted over independent
    /// blocks; a negative value supports the effect.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bic_change: Option<f64>,
    /// Relative reduction of the validation error by this effect in the complete model, compared with the complete
    /// model without it. Effects that mask each other have a small individual reduction.
    #[serde(default)]
    pub error_reduction_together: f64,
    /// Family-wise, from sign flips of whole blocks.
    pub p_value: f64,
    /// Class of the evidence, from the p-value and the error reductions.
    #[serde(default)]
    #[schema(required)]
    pub evidence: Evidence,
    /// No flip reached this score, so that `p_value` is an upper limit.
    #[serde(default)]
    pub p_at_most: bool,
    /// Parameters in the complete model with all suggestions, where `discover` ends.
    pub parameters: Vec<Parameter>,
    /// Effects that explain this data as well.
    pub confounded_with: Vec<String>,
    /// What the effect is, its evidence and its confounded effects, in sentences.
    pub why: String,
    /// The same without the description of the effect.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub reasons: String,
}

/// A run that would answer the questions that this run cannot answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Experiment {
    /// Name of the procedure.
    pub procedure: String,
    /// Parameters of the procedure by name; empty if the defaults apply.
    #[schema(value_type = Object)]
    pub parameters: serde_json::Map<String, serde_json::Value>,
    /// The question that the run answers, in words.
    pub why: String,
    /// Expected separation of the alternatives in standard deviations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected_z: Option<f64>,
    /// Longest duration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected_duration_s: Option<f64>,
    /// Effects that it distinguishes, or makes detectable.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub separates: Vec<String>,
}

/// An effect that another one imitates: its absence hardly changes the error, but biases a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Imitated {
    /// Id of the effect that may be present.
    pub effect: String,
    /// The biased parameter of the given model, as `effect.parameter`.
    pub parameter: String,
    /// Unit of `without` and `with`.
    pub unit: String,
    /// Its value without the effect, and with it.
    pub without: f64,
    /// Its value with the effect.
    pub with: f64,
}

/// An effect that was tested and not found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Silent {
    /// Id of the effect.
    pub effect: String,
    /// Detection limit: RMS of the smallest effect that is found with 80 % power, in the unit of the fit.
    pub minimum_detectable_rms: f64,
    /// The effect is smaller than this RMS (95 %), in the unit of the fit; set by `bounded`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(required, value_type = f64)]
    pub upper_rms: Option<f64>,
    /// Tested range, if it is limited: `1 to 60 waves a turn`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sought: Option<String>,
}

/// One step of `discover`. The first one is the given model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Effect that this step added. Absent for the given model and for a removal.
    pub added: Option<String>,
    /// Why `added` was added. Absent if nothing was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub addition_reason: Option<AdditionReason>,
    /// An added effect that is removed again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub removed: Option<String>,
    /// Why `removed` was removed. Absent if nothing was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub removal_reason: Option<RemovalReason>,
    /// Effects that explain this data as well as the added one, in the final model too.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub confounded_with: Vec<String>,
    /// Effect ids of the model after this step.
    pub model: Vec<String>,
    /// Training error after this step, in the unit of the fit.
    pub rms: f64,
    /// Validation error after this step, in the unit of the fit.
    pub validation_rms: f64,
}

/// Result of `discover`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Discovery {
    /// Kind of the run and the model.
    pub kind: Kind,
    /// The given model, then one step for each added or removed effect.
    pub steps: Vec<Step>,
    /// Data that the residual and all RMS figures refer to.
    pub residual: ResidualKind,
    /// Noise floor of the run, comparable with the RMS figures. Absent without repeats.
    pub noise_floor_rms: Option<f64>,
    /// The noise floor with its interval and source.
    pub noise_floor: NoiseFloor,
    /// The conclusion on the final model.
    pub verdict: Verdict,
    /// Why the verdict is undecided: too little data to reject the model, so that `adequate` only means that nothing
    /// was found, or contradicting columns. `jointbench` then ends with code 3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undecided: Option<String>,
    /// The category of that reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undecided_reason: Option<UndecidedReason>,
    /// The conclusion in plain sentences.
    pub summary: String,
    /// Effect ids of the final model.
    pub model: Vec<String>,
    /// The final model, fitted to the run.
    pub fit: Fit,
    /// Regions where the final model has a significant residual, the worst first.
    #[serde(rename = "where")]
    pub regions: Vec<Region>,
    /// The residual over the two axes with most structure, for the verdict `unexplained_structure`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub structure: Option<PairMap>,
    /// The columns with most structure, as named in the summary. Empty without structure.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shows_over: Vec<String>,
    /// An effect that may be present in addition to those of the model and changes the parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imitated: Option<Imitated>,
    /// The recommended next run. Without a menu (`next_run`) only missing repeats are recommended, otherwise it is absent.
    pub experiment: Option<Experiment>,
    /// Effects that were tested and not found, with their detection limits.
    #[serde(default)]
    pub silent: Vec<Silent>,
    /// Effects that this data cannot show.
    #[serde(default)]
    pub not_visible: Vec<Invisible>,
    /// Effects that were tested and rejected.
    #[serde(default)]
    pub left_out: Vec<LeftOut>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn evidence_is_as_strong_as_its_figures() {
        let class = |p_value, alone, ci95, together, has_size| Evidence::of(p_value, alone, ci95, together, has_size).0;
        assert_eq!(class(0.002, 0.3, Some([0.2, 0.4]), 0.3, true), Evidence::Strong);
        assert_eq!(class(0.03, 0.3, Some([0.2, 0.4]), 0.3, true), Evidence::Weak);
        assert_eq!(class(0.002, 0.15, Some([-0.01, 0.3]), 0.16, true), Evidence::Weak);
        assert_eq!(class(0.002, 0.01, Some([-0.01, 0.03]), 0.3, true), Evidence::Strong, "masked by another");
        assert_eq!(class(0.002, 0.02, Some([0.01, 0.03]), 0.02, true), Evidence::Small);
        assert_eq!(class(0.002, 0.3, None, 0.0, true), Evidence::Strong, "where the RMS does not look");
        assert_eq!(class(0.002, -0.04, Some([-0.07, -0.01]), -0.03, true), Evidence::Weak, "a larger error");
        let (weak, why) = Evidence::of(0.002, 0.3, Some([0.2, 0.4]), 0.3, false);
        assert_eq!(
            (weak, why.as_deref()),
            (Evidence::Weak, Some("the intervals of all its coefficients include zero"))
        );
    }
}
