//! Where a model fails and what is missing.

use crate::OwnEffect;
use crate::report::fit::{Fit, Parameter, ResidualKind};
use crate::report::maps::{PairMap, Region};
use crate::thresholds::{MASKED_RATIO, SMALL_REDUCTION, STRONG_P_VALUE};
use jointbench_instrument::Kind;
use serde::{Deserialize, Serialize};

/// Why a verdict decides nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UndecidedReason {
    /// The columns of the run contradict each other.
    ContradictoryColumns,
    /// Too few independent blocks to name anything.
    TooFewBlocks,
    /// How well the run repeats itself is not known.
    NoNoiseFloor,
    /// A parameter contradicts physics in every model.
    ImpossibleParameter,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing reproducible is left that the library or the maps could name.
    Adequate,
    /// At least one effect of the library is missing.
    MissingEffect,
    /// Structure remains that no effect of the library explains.
    UnexplainedStructure,
}

/// The answer of `diagnose`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Diagnosis {
    pub kind: Kind,
    pub model: Vec<String>,
    /// Users' effects that the diagnosis knew.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub own: Vec<OwnEffect>,
    pub fit: Fit,
    pub residual: ResidualKind,
    /// Repeatability of the run, of the same kind as the RMS figures. `None` without repeats.
    pub noise_floor_rms: Option<f64>,
    pub noise_floor: NoiseFloor,
    pub verdict: Verdict,
    /// Why the verdict decides nothing: too little was measured to find fault with the model, so that `adequate` says no more
    /// than that nothing was found, or the columns contradict each other. With it `jointbench` ends with code 3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undecided: Option<String>,
    /// The kind of that reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undecided_reason: Option<UndecidedReason>,
    /// One plain sentence.
    pub summary: String,
    /// Regions in which the model errs, the worst first.
    #[serde(rename = "where")]
    pub regions: Vec<Region>,
    /// The residual over the two axes where it shows most, where the verdict is `unexplained_structure`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub structure: Option<PairMap>,
    /// The columns that the summary names as those over which what remains shows most. Empty where none does.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shows_over: Vec<String>,
    /// Whether structure remains even beside all suggestions.
    #[serde(default)]
    pub structure_remains: bool,
    /// Missing effects, the most important first. Empty unless the verdict is `missing_effect`.
    pub suggestions: Vec<Suggestion>,
    /// An effect that may be there beside the suggestions, and change the parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imitated: Option<Imitated>,
    pub experiment: Option<Experiment>,
    /// Effects that were looked for and not found, with what would have been seen.
    pub silent: Vec<Silent>,
    /// Effects that this data cannot show.
    pub not_visible: Vec<Invisible>,
    /// Effects that were tried and left out.
    #[serde(default)]
    pub left_out: Vec<LeftOut>,
}

/// How well the measurement repeats itself.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct NoiseFloor {
    pub rms: Option<f64>,
    pub ci95: Option<[f64; 2]>,
    /// Where the figure comes from, in words.
    pub source: String,
    /// Share of the remaining squared error that is the same in every repeat.
    pub repeatable_share: Option<f64>,
    /// Of that share. Where it reaches to zero, chance may have made it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeatable_ci95: Option<[f64; 2]>,
}

/// How sure it is that an effect is missing, and whether it matters.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    #[default]
    Strong,
    /// Sure, and less than [`SMALL_REDUCTION`] of the held-out error.
    Small,
    /// It may be missing: chance would name one of the library in more than [`STRONG_P_VALUE`] of such runs, or what it takes of the
    /// held-out error may be nothing.
    Weak,
}

impl Evidence {
    /// From the figures of a suggestion.
    pub fn of(p_value: f64, alone: f64, ci95: Option<[f64; 2]>, together: f64) -> Self {
        // Effects that mask each other show little alone.
        let may_be_nothing = together <= MASKED_RATIO * alone && ci95.is_some_and(|[low, _]| low <= 0.0);
        match () {
            () if p_value > STRONG_P_VALUE || may_be_nothing => Self::Weak,
            () if alone.max(together) < SMALL_REDUCTION => Self::Small,
            () => Self::Strong,
        }
    }
}

/// One missing effect with its evidence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Suggestion {
    pub effect: String,
    /// Held-out error of the model with this effect.
    pub validation_rms: f64,
    /// RMS error of the effects alone on the fitted data. `None` of a fit without nuisance terms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effects_rms: Option<f64>,
    /// 1 − validation_rms / validation_rms of the present model.
    pub error_reduction: f64,
    /// From the scatter over what was held out. `None` for an effect that is judged elsewhere than where the RMS looks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_reduction_ci95: Option<[f64; 2]>,
    /// Change of the Bayesian information criterion over independent pieces; below 0 it speaks for the effect.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bic_change: Option<f64>,
    /// Share of the held-out error that the effect takes away beside all other suggestions: what the complete model is
    /// better by than the complete model without it. Effects that mask each other show little alone.
    #[serde(default)]
    pub error_reduction_together: f64,
    /// Family-wise, from sign flips of whole blocks.
    pub p_value: f64,
    #[serde(default)]
    pub evidence: Evidence,
    /// No flip scored as high: the chance is `p_value` at most.
    #[serde(default)]
    pub p_at_most: bool,
    /// As they are in the complete model, where `discover` ends: beside all other suggestions.
    pub parameters: Vec<Parameter>,
    /// Effects that explain this data as well.
    pub confounded_with: Vec<String>,
    pub why: String,
}

/// A run that would decide what this one leaves open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Experiment {
    pub procedure: String,
    pub parameters: serde_json::Map<String, serde_json::Value>,
    pub why: String,
    /// Expected separation of the rivals in standard deviations, before it is run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected_z: Option<f64>,
    /// Longest duration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected_duration_s: Option<f64>,
    /// Effects that it tells apart, or shows for the first time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub separates: Vec<String>,
}

/// An effect that the shape of another one imitates: the error hardly tells whether it is there, a parameter does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Imitated {
    pub effect: String,
    /// The parameter of the given model that it changes, as `effect.parameter`.
    pub parameter: String,
    pub unit: String,
    /// Its value without the effect, and with it.
    pub without: f64,
    pub with: f64,
}

/// An effect that was looked for and not found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Silent {
    pub effect: String,
    /// RMS of the smallest effect of this kind that would have been found with 80 % probability, in the fit's unit.
    pub minimum_detectable_rms: f64,
    /// Within what it was looked for, where that has ends: `1 to 60 waves a turn`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sought: Option<String>,
}

/// An effect that was tried and is not in the model, though it might be there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LeftOut {
    pub effect: String,
    pub why: String,
}

/// An effect that this data cannot show.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Invisible {
    pub effect: String,
    pub why: String,
}

/// One step of `discover`. The first is the model that was given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Step {
    pub added: Option<String>,
    /// An effect that lost its reason when others came in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub removed: Option<String>,
    /// Effects that explain this data as well as the one that was added, and did not turn out otherwise later.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub confounded_with: Vec<String>,
    pub model: Vec<String>,
    pub rms: f64,
    pub validation_rms: f64,
}

/// The answer of `discover`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Discovery {
    pub kind: Kind,
    pub steps: Vec<Step>,
    pub residual: ResidualKind,
    pub noise_floor_rms: Option<f64>,
    pub noise_floor: NoiseFloor,
    pub verdict: Verdict,
    /// Why the verdict decides nothing: too little was measured to find fault with the model, so that `adequate` says no more
    /// than that nothing was found, or the columns contradict each other. With it `jointbench` ends with code 3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undecided: Option<String>,
    /// The kind of that reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undecided_reason: Option<UndecidedReason>,
    pub summary: String,
    pub model: Vec<String>,
    pub fit: Fit,
    #[serde(rename = "where")]
    pub regions: Vec<Region>,
    /// The residual over the two axes where it shows most, where the verdict is `unexplained_structure`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub structure: Option<PairMap>,
    /// The columns that the summary names as those over which what remains shows most. Empty where none does.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shows_over: Vec<String>,
    /// An effect that may be there beside those of the model, and change the parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imitated: Option<Imitated>,
    pub experiment: Option<Experiment>,
    /// Effects that were looked for and not found, with what would have been seen.
    #[serde(default)]
    pub silent: Vec<Silent>,
    /// Effects that this data cannot show.
    #[serde(default)]
    pub not_visible: Vec<Invisible>,
    /// Effects that were tried and left out.
    #[serde(default)]
    pub left_out: Vec<LeftOut>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn evidence_is_as_strong_as_its_figures() {
        assert_eq!(Evidence::of(0.002, 0.3, Some([0.2, 0.4]), 0.3), Evidence::Strong);
        assert_eq!(Evidence::of(0.03, 0.3, Some([0.2, 0.4]), 0.3), Evidence::Weak);
        assert_eq!(Evidence::of(0.002, 0.15, Some([-0.01, 0.3]), 0.16), Evidence::Weak);
        assert_eq!(Evidence::of(0.002, 0.01, Some([-0.01, 0.03]), 0.3), Evidence::Strong, "masked by another");
        assert_eq!(Evidence::of(0.002, 0.02, Some([0.01, 0.03]), 0.02), Evidence::Small);
        assert_eq!(Evidence::of(0.002, 0.3, None, 0.0), Evidence::Strong, "where the RMS does not look");
    }
}
