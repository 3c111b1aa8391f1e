//! Export and import of fitted models: JSON, C for a controller, tables, attributes of simulators.

pub(crate) mod c;
pub(crate) mod file;
pub(crate) mod joint;
pub(crate) mod load_noise;
pub(crate) mod online_prediction;
pub(crate) mod parts;
pub(crate) mod predict;
pub(crate) mod suffix;
pub(crate) mod table;
pub(crate) mod terms;

pub use crate::export::file::ModelFile;
pub use crate::export::online_prediction::OnlinePrediction;
pub use crate::export::predict::{Moments, predict};

use crate::ModelError;
use crate::export::parts::Parts;
use crate::preprocess::Problem;
use crate::report::fit::{Fit, SignalRange};
use crate::signal::Signal;
use crate::user_effects::signals_with;
use jointbench_instrument::Kind;

/// Export formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// The complete fit, the only format for import.
    Json,
    /// A self-contained C99 header.
    C,
    /// CSV over at most two signals.
    Table,
    /// `<joint …/>` of MuJoCo.
    Mujoco,
    /// `<dynamics …/>` of URDF.
    Urdf,
}

impl Format {
    /// Every format.
    pub const ALL: [Format; 5] = [Format::Json, Format::C, Format::Table, Format::Mujoco, Format::Urdf];

    /// Name of the format on the command line and in REST: `json`, `c`, `lut`, `mujoco` or `urdf`.
    pub fn name(self) -> &'static str {
        match self {
            Format::Json => "json",
            Format::C => "c",
            Format::Table => "lut",
            Format::Mujoco => "mujoco",
            Format::Urdf => "urdf",
        }
    }

    /// File name extension.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Json => "json",
            Format::C => "h",
            Format::Table => "csv",
            Format::Mujoco => "xml",
            Format::Urdf => "urdf",
        }
    }
}

/// Exports a fit. The first comment names what the format cannot contain.
pub fn export(fit: &Fit, format: Format) -> Result<String, ModelError> {
    match format {
        Format::Json => ModelFile::new(fit.clone()).to_json(),
        Format::C => c::header(fit),
        Format::Table => table::table(fit),
        Format::Mujoco => joint::joint(fit, joint::Dialect::Mujoco),
        Format::Urdf => joint::joint(fit, joint::Dialect::Urdf),
    }
}

/// The predicted quantity, in a word.
fn quantity(kind: Kind) -> &'static str {
    match kind {
        Kind::Friction => "motor_torque",
        Kind::Encoder => "error",
        Kind::Stiffness => "torsion",
        Kind::Brake => "brake_torque",
    }
}

fn predicted(fit: &Fit) -> String {
    let what = match fit.kind {
        Kind::Friction => "torque that the motor needs, motor side",
        Kind::Encoder => "test encoder minus reference",
        Kind::Stiffness => "motor position by the gear ratio minus link position",
        Kind::Brake => "braking torque",
    };
    format!("{what} [{}]", fit.unit)
}

/// Information for users of the export without its run, one line each. The ranges are those of the signals that the
/// exported part depends on.
fn about(fit: &Fit, parts: &Parts, left_out: &[(&str, String)], errors: Vec<String>) -> Vec<String> {
    let mut lines = vec![
        format!("jointbench {}: {} model, {}", env!("CARGO_PKG_VERSION"), fit.kind, predicted(fit)),
        format!("Effects: {}", fit.effects.join(", ")),
    ];
    lines.extend(errors);
    let named = signals_with(fit.kind, &fit.user_effects);
    let is_input = |range: &&SignalRange| {
        let signal = named.iter().find(|s| s.name == range.name);
        signal.is_some_and(|s| s.signal != Signal::Direction && parts.uses(s.signal))
    };
    for signal in fit.scope.iter().flat_map(|s| &s.signals).filter(is_input) {
        lines.push(format!("Fitted where {} is {:.4} to {:.4} {}", signal.name, signal.min, signal.max, signal.unit));
    }
    lines.extend(left_out.iter().map(|(effect, why)| format!("NOT CARRIED OVER: {effect} ({why})")));
    lines.extend(fit.notes.iter().map(|note| format!("Note: {note}")));
    lines
}

/// The error of the model, which equals that of the export if it is complete.
fn of_model(fit: &Fit, left_out: &[(&str, String)]) -> String {
    let of = if left_out.is_empty() { "" } else { " of the whole model, what is not carried over included" };
    format!("Error{of}: {}", error(fit))
}

/// The error of the effects, which are all that is exported.
fn error(fit: &Fit) -> String {
    match fit.effects_rms {
        Some(rms) => format!("{rms:.4e} {} rms on the run that was fitted", fit.unit),
        None => format!("{:.4e} {} rms on data excluded from the fit", fit.validation_rms, fit.unit),
    }
}

/// Measures the errors of the exports on the fitted run.
pub(crate) fn measure(fit: &mut Fit, problem: &Problem) -> Result<(), ModelError> {
    let means = table::curves(fit, problem)?;
    let fed_rms = load_noise::error(fit, problem)?;
    fit.scope.iter_mut().for_each(|scope| (scope.means, scope.fed_rms) = (means.clone(), fed_rms));
    let table_rms = table::on_run(fit, problem)?;
    fit.scope.iter_mut().for_each(|scope| scope.table_rms = table_rms);
    Ok(())
}

#[cfg(test)]
mod tests;
