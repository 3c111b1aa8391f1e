//! A fitted model.

use crate::report::setting::ParameterSetting;
use crate::thresholds::ELEMENT_WEIGHT;
use crate::{Definition, UserEffect};
use jointbench_instrument::{Kind, Motion};
use serde::{Deserialize, Deserializer, Serialize};
use utoipa::ToSchema;

/// The data of RMS figures and residuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ResidualKind {
    /// Filtered and decimated samples.
    Raw,
    /// Means over short chunks at steady state.
    PlateauMean,
}

/// A model with the parameters that fit one run best.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Fit {
    /// Kind of the fitted run, which determines the response.
    #[schema(value_type = String)]
    pub kind: Kind,
    /// Effect ids in the order of the model, including effects that the run cannot show.
    pub effects: Vec<String>,
    /// Definitions of the user effects that the fit contains.
    #[serde(default, rename = "own", skip_serializing_if = "Vec::is_empty")]
    #[schema(value_type = Vec<Definition>)]
    pub user_effects: Vec<UserEffect>,
    /// Fixed values, bounds and start values that a user has set.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub settings: Vec<ParameterSetting>,
    /// Training error: RMS of the residual on the fitted data, in `unit`.
    pub rms: f64,
    /// Validation error: RMS on data that the fit did not use; the other conditions predict every condition.
    pub validation_rms: f64,
    /// RMS error of the effects alone on the fitted data, as an exported model predicts. Absent for a fit without
    /// nuisance terms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effects_rms: Option<f64>,
    /// Unit of the response and of every RMS: `Nm` or `rad`, for a sliding axis `N` or `m`.
    pub unit: String,
    /// Data that the residual and all RMS figures refer to.
    pub residual: ResidualKind,
    /// ‖residual‖ / ‖measured‖.
    pub relative_error: f64,
    /// Coefficients and nonlinear parameters, in the order of `effects`.
    pub parameters: Vec<Parameter>,
    /// Pairs of parameters with a trade-off.
    pub trade_offs: Vec<TradeOff>,
    /// Condition number of the scaled columns.
    #[serde(deserialize_with = "open_end")]
    #[schema(value_type = Option<f64>)]
    pub condition: f64,
    /// Notes for the user, in plain sentences.
    pub notes: Vec<String>,
    /// How the run was preprocessed.
    pub preparation: Preparation,
    /// The parameters in the structure of the effects, for predictions.
    pub terms: Vec<Term>,
    /// Nuisance terms for the form error of a run that is judged sample by sample; they belong to the run, not to the
    /// model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub form_error: Vec<FormErrorTerm>,
    /// Absent in fits of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scope: Option<Scope>,
}

/// One number of the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = FittedParameter)]
pub struct Parameter {
    /// Id of the effect that the parameter belongs to.
    pub effect: String,
    /// Name within the effect: `tau_c`.
    pub name: String,
    /// Estimate in `unit`; 0 if the run cannot show the effect.
    pub value: f64,
    /// Unit of value and interval, `1` if dimensionless.
    pub unit: String,
    /// 95 % interval over segments or repeats (delete-group jackknife, t with G − 1 degrees of freedom).
    #[serde(deserialize_with = "open_interval")]
    #[schema(value_type = Vec<Option<f64>>, min_items = 2, max_items = 2)]
    pub ci95: [f64; 2],
    /// Whether the run determines the parameter, and its value is possible.
    pub state: ParameterState,
    /// The state in words, if it is not `ok`. In a diagnosis also the value with an effect that the run does not
    /// exclude.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// How well a run determines a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ParameterState {
    /// The run determines the value, and the value is physically possible.
    Ok,
    /// The estimate is at a bound of the physically plausible range, or at a bound that a user has set.
    AtBound,
    /// A user or an earlier step has fixed the value. It is no estimate, and its interval has no width.
    Fixed,
    /// The whole interval of a coefficient is outside its physical range, or outside the range of the user.
    Impossible,
    /// The data does not determine the parameter: its interval is as wide as the value.
    Unidentified,
}

/// JSON has no infinity: `null` represents an unbounded side.
fn open_interval<'de, D: Deserializer<'de>>(source: D) -> Result<[f64; 2], D::Error> {
    let [low, high] = <[Option<f64>; 2]>::deserialize(source)?;
    Ok([low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY)])
}

fn open_end<'de, D: Deserializer<'de>>(source: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(source)?.unwrap_or(f64::INFINITY))
}

/// Two parameters of which the data determines only a combination.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TradeOff {
    /// `effect.parameter`.
    pub first: String,
    /// The other parameter, as `effect.parameter`.
    pub second: String,
    /// Correlation of both estimates, −1 to 1; reported if its absolute value exceeds 0.95.
    pub correlation: f64,
}

/// Preprocessing of the run for the fit. A run is preprocessed in the same way when the fit is evaluated on it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Preparation {
    /// The data that the fit uses.
    pub residual: ResidualKind,
    /// Sample rate of the recorded run, 1 / median time step [Hz].
    pub sample_rate_hz: f64,
    /// Absent without a filter.
    pub cutoff_hz: Option<f64>,
    /// Corrected delay of the measured velocity against the position. Absent without a correction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_lag_s: Option<f64>,
    /// Every n-th filtered sample is used; 1 without decimation.
    pub decimation: usize,
    /// The presliding direction of motion. Absent if the direction is the sign of the velocity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bristles: Option<Bristles>,
    /// Length of a chunk. In a long run in steps, a row is the mean of several neighbouring chunks.
    pub chunk_s: Option<f64>,
    /// Samples of the recorded run.
    pub samples: usize,
    /// Rows of the fit: chunks or decimated samples.
    pub rows: usize,
    /// Independent blocks for validation, intervals and tests.
    pub blocks: usize,
    /// Source of the segments: `column`, `found` or `operating points`.
    pub segments_from: String,
    /// Source of the repeats: `column`, `found` or `none`.
    pub repeats_from: String,
}

/// A direction that changes over a displacement: weighted stop operators, which slip at ±1, and Dahl elements with
/// exponential approach.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Bristles {
    /// Reaches of the stop operators, the shortest first; the Dahl elements have the same without the shortest [rad].
    pub reaches_rad: Vec<f64>,
    /// Weights of the stop operators, then of the Dahl elements.
    pub weights: Vec<f64>,
    /// Without presliding the direction changes within this speed [rad/s].
    pub band_rad_s: f64,
}

impl Bristles {
    /// An equivalent single element: its form in the library and its reach, with the range of reaches that have
    /// weight.
    pub(crate) fn single(&self) -> Option<(&'static str, f64, [f64; 2])> {
        let n = self.reaches_rad.len();
        let reach = |at: usize| self.reaches_rad.get(if at < n { at } else { at + 1 - n }).copied();
        let form = |at: usize| if at < n { "stop" } else { "dahl" };
        let best = (0..self.weights.len()).max_by(|a, b| self.weights[*a].total_cmp(&self.weights[*b]))?;
        let ends = (0..self.weights.len()).filter(|at| self.weights[*at] > ELEMENT_WEIGHT).filter_map(reach);
        let ends = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], r| [low.min(r), high.max(r)]);
        Some((form(best), reach(best)?, ends))
    }
}

/// A nuisance column for the form error of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FormErrorTerm {
    /// `bristle`, `bristle_rate`, `jerk`, `snap` or `load_rate`, or an effect, for another form of it.
    pub name: String,
    /// Name of the form if the term is an effect, otherwise empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub form: String,
    /// Nonlinear parameters for another form, otherwise the place of the column.
    pub shape: Vec<f64>,
    /// Coefficients of the columns.
    pub linear: Vec<f64>,
}

/// One effect of the model, as numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Term {
    /// Id of the effect.
    pub effect: String,
    /// The best form of the effect.
    pub form: String,
    /// Nonlinear parameters.
    pub shape: Vec<f64>,
    /// Coefficients of the effect's columns.
    pub linear: Vec<f64>,
    /// Names of the coefficients, then of the nonlinear parameters.
    #[serde(default)]
    pub names: Vec<String>,
}

/// Range of validity of a fit, for its use without the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Scope {
    /// Whether the joint rotates or slides, which determines the units.
    #[schema(value_type = String)]
    pub motion: Motion,
    /// Factor from the load in model quantities to the link torque: the gear ratio for friction runs, otherwise 1.
    pub load_scale: f64,
    /// Time step of the samples on which hysteresis effects were simulated [s].
    pub sample_s: f64,
    /// Ranges of the signals at the points of the fit, by their formula names.
    pub signals: Vec<SignalRange>,
    /// Constants of the set-up that converted measured columns to model quantities. Empty in fits of earlier
    /// versions.
    #[serde(default)]
    pub constants: Vec<GivenConstant>,
    /// Error of the hysteresis states in C code, with the measured load instead of the smoothed one. Absent if the
    /// fit smoothed no signal of a hysteresis state.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fed_rms: Option<f64>,
    /// Mean curves of hysteresis effects.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub means: Vec<MeanCurve>,
    /// Error of the look-up table with linear interpolation at the points of the run. Absent in fits of earlier
    /// versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table_rms: Option<f64>,
}

/// The mean curve of a hysteresis effect over its signal, fitted to the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeanCurve {
    /// Id of the hysteresis effect.
    pub effect: String,
    /// Formula name of the signal.
    pub signal: String,
    /// Values of the signal at the supporting points, ascending.
    pub at: Vec<f64>,
    /// Mean contribution of the effect at these points, in the unit of the fit; as many as `at`.
    pub mean: Vec<f64>,
    /// RMS difference between the effect and the curve.
    pub off_rms: f64,
}

/// A constant of the set-up, by its name in the meta file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct GivenConstant {
    /// Name in the meta file, with its unit: `torque_constant_nm_per_a`.
    pub name: String,
    /// Value in the unit of the name.
    pub value: f64,
}

/// Smallest and largest value of a signal at the points of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SignalRange {
    /// Name of the signal in formulas.
    pub name: String,
    /// Unit of the range and the noise.
    pub unit: String,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// RMS of the noise that the fit removed from the signal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<f64>,
}

/// A fit on a run that was not used for it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Evaluation {
    /// RMS of the residual on the evaluated run, in `unit`.
    pub rms: f64,
    /// RMS error of the effects alone. Absent for a fit without nuisance terms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effects_rms: Option<f64>,
    /// Unit of both RMS figures.
    pub unit: String,
    /// Data that the residual refers to, as in the fit.
    pub residual: ResidualKind,
    /// ‖residual‖ / ‖measured‖.
    pub relative_error: f64,
    /// Rows that were predicted: chunks or decimated samples.
    pub rows: usize,
    /// Samples of the evaluated run.
    pub samples: usize,
    /// Fraction of the samples at steady state, if only these are judged.
    pub settled_share: Option<f64>,
    /// Limitations of the error, in plain sentences: missing columns, constants that differ from those of the fit,
    /// signals outside its ranges.
    pub notes: Vec<String>,
}
