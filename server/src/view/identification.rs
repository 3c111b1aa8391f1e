//! What a procedure makes of its run.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Identified {
    Identified,
    /// Identified, although the run found a precondition broken; `warnings` tells which.
    IdentifiedWithWarning,
    /// The run says too little; `advice` tells what to measure.
    Inconclusive,
    /// The run cannot be used; `summary` tells why.
    Failed,
}

impl Identified {
    /// With or without a warning.
    pub fn is_identified(self) -> bool {
        matches!(self, Self::Identified | Self::IdentifiedWithWarning)
    }
}

/// Worked out from the stored samples each time it is asked for, by the version that answers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Identification {
    pub run: i64,
    pub procedure: String,
    /// The version of jointbench that worked it out.
    pub software: String,
    #[serde(flatten)]
    pub result: Shown,
    /// The run that uses what was found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub follow_up: Option<FollowUp>,
    pub applies: Applies,
}

/// Whether the next runs of the bench can be made to use the result (`POST /bench/{bench}/calibrations`).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Applies {
    pub can: bool,
    /// What becomes of it then, or why it cannot be.
    pub what: String,
}

/// A run for which this one has found the parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FollowUp {
    pub procedure: String,
    #[schema(value_type = Object)]
    pub parameters: Map<String, Value>,
    /// What it is good for, in a few words.
    pub why: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Shown {
    pub verdict: Identified,
    /// One plain sentence, or a line for each part of a campaign.
    pub summary: String,
    /// Preconditions that the run itself found broken, such as a joint that was not warmed up.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// What to measure or mend next.
    pub advice: Option<String>,
    pub quantities: Vec<Quantity>,
    pub figures: Vec<Figure>,
}

impl Shown {
    /// With preconditions that the run found broken. The rule: what was identified is identified with a warning; what is
    /// inconclusive or failed stays so.
    pub fn with_warnings(mut self, warnings: Vec<String>) -> Self {
        if self.verdict == Identified::Identified && !warnings.is_empty() {
            self.verdict = Identified::IdentifiedWithWarning;
        }
        self.warnings = warnings;
        self
    }
}

/// What an earlier run of the same bench and procedure has found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Earlier {
    pub run: i64,
    pub created_at: String,
    /// It is applied to the bench: changes are told against it.
    pub holds: bool,
    pub quantities: Vec<Quantity>,
}

/// What complete runs have found, the oldest first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Trends {
    pub runs: Vec<TrendRun>,
    /// Runs whose figures are not worked out yet: ask again.
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
    pub tags: Vec<String>,
    /// Mean over the run; `null` where no temperature was measured.
    pub temperature_c: Option<f64>,
    pub quantities: Vec<Quantity>,
}

/// A run beside the last model of its kind that its bench has from another run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Beside {
    pub model: i64,
    /// The run that the model was fitted to first.
    pub model_run: i64,
    /// How far the model's own run scatters about it, in the unit of the figures.
    pub noise_rms: f64,
    /// Whether that is the noise floor of its run, or the model's held-out error where no floor is known.
    pub has_noise_floor: bool,
    /// Points of this run that the model speaks of.
    pub points: usize,
    /// Share of them further from the model than two of its standard deviations; 0.05 where the model explains the run.
    pub outside: Option<f64>,
    /// Why there is nothing to show yet.
    pub why_not: Option<String>,
    /// Measured and model over time, and what it leaves with the band of the noise.
    pub figures: Vec<Figure>,
}

/// One figure of a result, in SI units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Quantity {
    /// Stable and unique in its result: what scripts and limits hold on to.
    pub name: String,
    /// As in the literature: `τ_c⁺`.
    pub symbol: String,
    pub title: String,
    /// SI symbol; empty for a share or a count.
    pub unit: String,
    pub value: f64,
    /// 95 % interval, where one can be had from the run.
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub ci95: Option<[f64; 2]>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Figure {
    pub name: String,
    pub title: String,
    pub form: FigureForm,
    pub x: FigureAxis,
    pub y: FigureAxis,
    pub series: Vec<FigureSeries>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FigureForm {
    Cartesian,
    /// x is the angle [rad], y the radius.
    Polar,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FigureAxis {
    pub label: String,
    /// SI symbol; empty for a share or a count.
    pub unit: String,
    /// Where the axis counts things that have names, instead of a quantity: 0 is the first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub names: Vec<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mark {
    Points,
    Line,
    Bars,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FigureSeries {
    pub label: String,
    pub mark: Mark,
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    /// Lower and upper end of the 95 % band at each point; empty where there is none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(value_type = Vec<Vec<f64>>)]
    pub band: Vec<[f64; 2]>,
}
