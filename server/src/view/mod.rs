//! Output of the daemon: the same serialisable types for REST, the live stream, the demo and `--json`.
//!
//! SI units with the unit as suffix of the name. No number is NaN or infinite: [`finite`] converts an unknown value to
//! `null`. Results of the lower crates come as JSON from the store or from a job, and a number refuses `null`.

mod archive;
mod autopilot;
mod bench;
mod calibration;
mod control_chart;
mod convert;
mod derived;
mod diagnosis;
mod effect;
mod identification;
mod import;
mod limits;
mod live;
mod log;
mod memory;
mod model;
mod notification;
mod procedure;
mod queue;
mod run;
mod table;
mod token;
mod unit;
mod user_effect;

pub use archive::*;
pub use autopilot::*;
pub use bench::*;
pub use calibration::*;
pub use control_chart::*;
pub use convert::*;
pub use derived::*;
pub use diagnosis::*;
pub use effect::*;
pub use identification::*;
pub use import::*;
pub use limits::*;
pub use live::*;
pub use log::*;
pub use memory::*;
pub use model::*;
pub use notification::*;
pub use procedure::*;
pub use queue::*;
pub use run::*;
pub use table::*;
pub use token::*;
pub use unit::*;
pub use user_effect::*;

/// Types of the lower layers that the API returns as they are.
pub use crate::store::{ProceedIf, QueueState, Unit};
pub use jointbench_model::{
    Comparison, Definition as EffectDefinition, Diagnosis as Finding, Evaluation, Experiment, Fit,
    Parameter as FittedParameter, ParameterSetting, ParameterState, Region, ResidualKind, Suggestion, Verdict,
};
pub use jointbench_procedure::identification::{
    Axis as FigureAxis, Figure, FollowUp, Form as FigureForm, Mark, Quantity, Series as FigureSeries,
};
pub use jointbench_procedure::preview::{Check, Extreme, Setpoints, StepPreview as PlannedStep};
pub use jointbench_procedure::{RunState, Safe};

/// `None` for NaN and infinity, which JSON cannot carry.
pub fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// A JSON value as text: whole numbers without a decimal point.
pub fn typed(value: &serde_json::Value) -> String {
    match value.as_f64() {
        Some(number) if number.fract() == 0.0 && number.abs() < 1e15 => format!("{number:.0}"),
        _ => value.to_string(),
    }
}

/// The command that starts a run with these settings.
pub fn command(procedure: &str, parameters: &serde_json::Map<String, serde_json::Value>) -> String {
    let set = parameters.iter().map(|(name, value)| format!(" --set {name}={}", typed(value)));
    format!("jointbench run {procedure}{}", set.collect::<String>())
}

/// The word of the API for a state: `safe_verified`.
pub fn word(value: impl serde::Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default()
}

/// The same for people: `safe verified`.
pub fn spoken(value: impl serde::Serialize) -> String {
    word(value).replace('_', " ")
}
