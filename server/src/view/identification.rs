//! Results of procedures.

use super::{Figure, FollowUp, LimitCheck, Quantity, word};
use jointbench_procedure::identification::{Part, Verdict};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Identified {
    Identified,
    /// Identified, although the run found a precondition broken; `warnings` lists them.
    IdentifiedWithWarning,
    /// The run says too little; `advice` names what to measure.
    Inconclusive,
    /// The run cannot be used; `summary` gives the reason.
    Failed,
}

impl Identified {
    /// With or without a warning.
    pub fn is_identified(self) -> bool {
        matches!(self, Self::Identified | Self::IdentifiedWithWarning)
    }
}

/// Computed from the stored samples at each request, by the running version.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Identification {
    pub run: i64,
    pub procedure: String,
    /// The version of jointbench that computed it.
    pub software: String,
    #[serde(flatten)]
    pub result: Shown,
    /// The run that uses the result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub follow_up: Option<FollowUp>,
    pub applies: Applies,
    /// The limits of the run, and whether the result meets them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<LimitCheck>,
}

impl Identification {
    /// The verdict in a line of text.
    pub fn line(&self) -> String {
        let Self { procedure, run, result, .. } = self;
        format!("{procedure} of run {run}: {}. {}", word(result.verdict), result.summary)
    }
}

/// Whether the result can be applied to the bench (`POST /bench/{bench}/calibrations`).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Applies {
    pub can: bool,
    /// Effect of applying it, or the reason why it cannot be applied; empty if no procedure uses the result.
    pub what: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Shown {
    pub verdict: Identified,
    /// One sentence, or one line per part of a campaign.
    pub summary: String,
    /// The summary without the outcome against a data sheet and without the lines of the parts; absent if the summary
    /// contains neither.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lead: Option<String>,
    /// Preconditions that the run itself found broken, such as a joint that was not warmed up.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// Advice for the next step.
    pub advice: Option<String>,
    pub quantities: Vec<Quantity>,
    pub figures: Vec<Figure>,
    /// Against a data sheet: whether it passes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub passes: Option<bool>,
    /// Parts of a campaign, in their order. The summary ends with a line for each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<CampaignPart>,
}

/// A part of a campaign.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CampaignPart {
    /// Procedure of the part; the names of its quantities and figures begin with it and a dot.
    pub id: String,
    pub title: String,
    pub verdict: Identified,
    pub summary: String,
    /// Names of its quantities.
    #[serde(default)]
    #[schema(required = true)]
    pub quantities: Vec<String>,
    /// Names of its figures.
    #[serde(default)]
    #[schema(required = true)]
    pub figures: Vec<String>,
}

impl Shown {
    /// A result with the preconditions that the run found broken. The rule: what was identified is identified with a
    /// warning; what is inconclusive or failed stays so.
    pub fn new(result: jointbench_procedure::Identification, warnings: Vec<String>) -> Self {
        let jointbench_procedure::Identification { verdict, summary, lead, advice, quantities, figures, passes, parts } =
            result;
        let verdict = match verdict {
            Verdict::Identified if !warnings.is_empty() => Identified::IdentifiedWithWarning,
            verdict => verdict.into(),
        };
        let parts = parts.into_iter().map(CampaignPart::from).collect();
        Self { verdict, summary, lead, warnings, advice, quantities, figures, passes, parts }
    }
}

impl From<Verdict> for Identified {
    fn from(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Identified => Self::Identified,
            Verdict::Inconclusive => Self::Inconclusive,
            Verdict::Failed => Self::Failed,
        }
    }
}

impl From<Part> for CampaignPart {
    fn from(part: Part) -> Self {
        let Part { id, title, verdict, summary, quantities, figures } = part;
        Self { id, title, verdict: verdict.into(), summary, quantities, figures }
    }
}

/// Results of an earlier run of the same bench and procedure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Earlier {
    pub run: i64,
    pub created_at: String,
    /// Applied to the bench: reference for changes.
    pub holds: bool,
    pub quantities: Vec<Quantity>,
}

/// What complete runs have found, the oldest first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Trends {
    pub runs: Vec<TrendRun>,
    /// Runs whose figures are not computed yet: repeat the request.
    pub pending: u64,
    /// Older runs that the search finds too.
    pub left_out: u64,
}

/// What one complete run has found, and under which conditions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TrendRun {
    pub run: i64,
    pub created_at: String,
    pub bench: String,
    pub procedure: String,
    /// Serial number of the unit under test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    pub tags: Vec<String>,
    /// Mean over the run; `null` where no temperature was measured.
    pub temperature_c: Option<f64>,
    pub quantities: Vec<Quantity>,
}

/// A run compared with the latest model of its kind from another run of the bench.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Beside)]
pub struct ModelOverlay {
    pub model: i64,
    /// The run that the model was fitted to first.
    pub model_run: i64,
    /// RMS scatter of the run of the model, in the unit of the figures.
    pub noise_rms: f64,
    /// Whether this is the noise floor of its run, or the validation error of the model if no floor is known.
    pub has_noise_floor: bool,
    /// Points of this run within the scope of the model.
    pub points: usize,
    /// Fraction of the points beyond two standard deviations from the model; 0.05 if the model explains the run.
    pub outside: Option<f64>,
    /// Reason why no comparison is available yet.
    pub why_not: Option<String>,
    /// Measured signal and model over time, and the residual with the noise band.
    pub figures: Vec<Figure>,
}
