//! A fitted model.

use crate::OwnEffect;
use jointbench_instrument::{Kind, Motion};
use serde::{Deserialize, Deserializer, Serialize};

/// What RMS figures and residuals are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ResidualKind {
    /// Filtered and decimated samples.
    Raw,
    /// Means over short chunks of settled motion.
    PlateauMean,
}

/// A model with the parameters that fit one run best.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    pub kind: Kind,
    pub effects: Vec<String>,
    /// Definitions of the effects that a user wrote: without them the fit means nothing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub own: Vec<OwnEffect>,
    /// Root mean square of the residual on the data that was fitted, in `unit`.
    pub rms: f64,
    /// The same on data that did not take part in the fit: every condition is predicted by the others.
    pub validation_rms: f64,
    /// RMS error of the effects alone on the fitted data, as an exported model predicts. `None` of a fit without nuisance terms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effects_rms: Option<f64>,
    pub unit: String,
    pub residual: ResidualKind,
    /// ‖residual‖ / ‖measured‖.
    pub relative_error: f64,
    pub parameters: Vec<Parameter>,
    /// Pairs of parameters that trade off against each other.
    pub trade_offs: Vec<TradeOff>,
    /// Condition number of the scaled columns.
    #[serde(deserialize_with = "open_end")]
    pub condition: f64,
    /// What a user should know, in plain sentences.
    pub notes: Vec<String>,
    pub preparation: Preparation,
    /// The same parameters as the effects hold them, to compute the model again.
    pub terms: Vec<Term>,
    /// What stands beside the effects where samples are judged: the run shows it, and no effect of the model says it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub form_error: Vec<FormErrorTerm>,
    /// `None` in fits of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scope: Option<Scope>,
}

/// One number of the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    pub effect: String,
    pub name: String,
    pub value: f64,
    pub unit: String,
    /// 95 % interval over segments or repeats (delete-group jackknife, t with G − 1 degrees of freedom).
    #[serde(deserialize_with = "open_interval")]
    pub ci95: [f64; 2],
    pub state: ParameterState,
    /// The state in words, where it is not `ok`; in a diagnosis also what it would be with an effect that the run leaves open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ParameterState {
    Ok,
    /// The best value lies at or beyond the edge of what is physically sensible.
    AtBound,
    /// The whole interval of a coefficient contradicts physics, or the range that a user gave it.
    Impossible,
    /// The data does not decide it: the interval is as wide as the value.
    Unidentified,
}

/// JSON has no infinity: `null` stands for a side without a bound.
fn open_interval<'de, D: Deserializer<'de>>(source: D) -> Result<[f64; 2], D::Error> {
    let [low, high] = <[Option<f64>; 2]>::deserialize(source)?;
    Ok([low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY)])
}

fn open_end<'de, D: Deserializer<'de>>(source: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(source)?.unwrap_or(f64::INFINITY))
}

/// Two parameters of which the data decides only a combination.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TradeOff {
    /// `effect.parameter`.
    pub first: String,
    pub second: String,
    pub correlation: f64,
}

/// How the run was prepared for the fit. A run is prepared in the same way when the fit is evaluated on it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Preparation {
    pub residual: ResidualKind,
    pub sample_rate_hz: f64,
    /// `None` where nothing was filtered.
    pub cutoff_hz: Option<f64>,
    /// By how much the measured velocity came after its position, and was moved back. `None` where it stays as it was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_lag_s: Option<f64>,
    pub decimation: usize,
    /// The direction of motion as contacts feel it. `None` where it is the sign of the velocity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bristles: Option<Bristles>,
    /// Length of a chunk. A row of a long run in steps is the mean of several neighbours.
    pub chunk_s: Option<f64>,
    pub samples: usize,
    /// Rows of the fit: chunks or decimated samples.
    pub rows: usize,
    /// Independent pieces for validation, intervals and tests.
    pub blocks: usize,
    /// Where the segments came from: `column` or `found`.
    pub segments_from: String,
    /// Where the repeats came from: `column`, `found` or `none`.
    pub repeats_from: String,
}

/// A direction that turns over a way: contacts that slip at ±1 and contacts that yield exponentially, weighed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bristles {
    /// Reaches of the contacts that slip, the shortest first; those that yield have the same but for the shortest [rad].
    pub reaches_rad: Vec<f64>,
    /// Shares of the ones that slip, then of the ones that yield.
    pub weights: Vec<f64>,
    /// Without bristles the direction turns within this speed [rad/s].
    pub band_rad_s: f64,
}

impl Bristles {
    /// The one contact that stands for all: its form in the library and its reach, with the ends of what has weight.
    pub(crate) fn single(&self) -> Option<(&'static str, f64, [f64; 2])> {
        const NONE: f64 = 0.05;
        let n = self.reaches_rad.len();
        let reach = |at: usize| self.reaches_rad.get(if at < n { at } else { at + 1 - n }).copied();
        let form = |at: usize| if at < n { "stop" } else { "dahl" };
        let best = (0..self.weights.len()).max_by(|a, b| self.weights[*a].total_cmp(&self.weights[*b]))?;
        let ends = (0..self.weights.len()).filter(|at| self.weights[*at] > NONE).filter_map(reach);
        let ends = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], r| [low.min(r), high.max(r)]);
        Some((form(best), reach(best)?, ends))
    }
}

/// A column beside the effects of a model, where the errors of their formulas live.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FormErrorTerm {
    /// `bristle`, `jerk`, `snap` or `load_rate`; or the effect of which it is another form.
    pub name: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub form: String,
    /// Of another form its shape, else the place of the column.
    pub shape: Vec<f64>,
    pub linear: Vec<f64>,
}

/// One effect of the model, as numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Term {
    pub effect: String,
    /// Which form of the effect fits best.
    pub form: String,
    /// Parameters that the effect is not linear in.
    pub shape: Vec<f64>,
    /// Factors of the effect's columns.
    pub linear: Vec<f64>,
    /// Names of the factors, then of the shape parameters.
    #[serde(default)]
    pub names: Vec<String>,
}

/// Where a fit holds: what someone needs who uses it far from its run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scope {
    pub motion: Motion,
    /// Factor from the load as the model sees it to the link torque: the gear ratio of friction runs, else 1.
    pub load_scale: f64,
    /// Step of the samples that memory effects were simulated on [s].
    pub sample_s: f64,
    /// Signals at the points of the fit, by the names that formulas use.
    pub signals: Vec<SignalRange>,
    /// Facts of the set-up that turned measured columns into what the model sees. Empty in fits of earlier versions.
    #[serde(default)]
    pub constants: Vec<GivenConstant>,
    /// Error of what remembers in C, fed with the load as the run felt it and not as the fit smoothed it. `None` where the
    /// fit smoothed nothing that is remembered.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fed_rms: Option<f64>,
    /// What effects that remember are on average.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub means: Vec<MeanCurve>,
    /// Error of the look-up table, read in straight lines at the points of the run. `None` in fits of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table_rms: Option<f64>,
}

/// An effect that remembers as the curve over what it remembers that comes nearest to it on the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeanCurve {
    pub effect: String,
    /// By the name that formulas use.
    pub signal: String,
    pub at: Vec<f64>,
    pub mean: Vec<f64>,
    /// How far the effect was off it.
    pub off_rms: f64,
}

/// A fact of the set-up, by its name in the meta file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GivenConstant {
    pub name: String,
    pub value: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SignalRange {
    pub name: String,
    pub unit: String,
    pub min: f64,
    pub max: f64,
    /// What the fit took off it as noise, rms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<f64>,
}

/// A fit on a run that took no part in it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    pub rms: f64,
    /// The same of the effects alone. `None` of a fit without nuisance terms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effects_rms: Option<f64>,
    pub unit: String,
    pub residual: ResidualKind,
    /// ‖residual‖ / ‖measured‖.
    pub relative_error: f64,
    pub rows: usize,
    pub samples: usize,
    /// Share of the samples that is settled motion, where only that is judged.
    pub settled_share: Option<f64>,
    /// What the error does not say by itself, in plain sentences: columns that are missing, facts that differ from those
    /// of the fit, signals that leave its ranges.
    pub notes: Vec<String>,
}
