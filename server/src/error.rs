//! Errors of the lab and their use.
//!
//! * [`LabError::NotFound`]: the named object does not exist.
//! * [`LabError::Invalid`]: the request is valid, but its values are not possible here; the message has the remedy.
//! * [`LabError::File`]: a measurement file or description was refused; contains file, line and column if known.
//! * [`LabError::Formula`]: an error in a user's effect, with its position.
//! * [`LabError::Conflict`]: a valid request at the wrong time (bench busy, bench blocked).
//! * [`LabError::Busy`]: the same request may succeed later (disk full, database locked, too many computations).
//! * [`LabError::Over`]: permanently too late (the run has ended, or another run has continued it).
//! * [`LabError::Gone`]: the samples are no longer in the store; the message names their file in the archive.
//! * [`LabError::Bench`]: an instrument does not work as required.
//! * [`LabError::TooLarge`]: the request exceeds the limit of memory or time.
//! * [`LabError::Setup`]: the daemon cannot start with this setup (port in use, folder not writable, old database).
//! * [`LabError::Internal`]: an internal fault; the detail is also logged.
//!
//! `api::problem` maps each error to HTTP, [`LabError::exit_code`] to a shell.

#[derive(Debug, Clone, thiserror::Error)]
pub enum LabError {
    #[error("{0}")]
    NotFound(String),
    #[error("{0}")]
    Invalid(String),
    #[error("{detail}")]
    File { detail: String, line: Option<u64>, column: Option<String> },
    #[error("{0}")]
    Formula(Box<jointbench_model::FormulaFault>),
    #[error("{0}")]
    Conflict(String),
    #[error("{0}")]
    Busy(String),
    #[error("{0}")]
    Over(String),
    #[error("{0}")]
    Gone(String),
    #[error("{0}")]
    Bench(String),
    #[error("{0}")]
    TooLarge(String),
    #[error("{0}")]
    Setup(String),
    #[error("{0}")]
    Internal(String),
}

impl LabError {
    pub fn no_run(id: i64) -> Self {
        LabError::NotFound(format!("run {id} does not exist"))
    }

    pub fn no_model(id: i64) -> Self {
        LabError::NotFound(format!(
            "model version {id} does not exist; GET /api/v1/models?run= lists the versions of a \
                                    run"
        ))
    }

    /// 0 success, 1 failed run or exceeded limit, 2 invalid arguments or input, 3 no decision possible.
    pub fn exit_code(&self) -> u8 {
        match self {
            LabError::Conflict(_) | LabError::Busy(_) | LabError::Bench(_) | LabError::Internal(_) => 1,
            LabError::NotFound(_)
            | LabError::Over(_)
            | LabError::Gone(_)
            | LabError::Invalid(_)
            | LabError::File { .. }
            | LabError::Formula(_)
            | LabError::TooLarge(_)
            | LabError::Setup(_) => 2,
        }
    }
}

impl From<crate::store::StoreError> for LabError {
    fn from(error: crate::store::StoreError) -> Self {
        use crate::store::StoreError as E;
        let message = error.to_string();
        match error {
            E::NoRun(id) => LabError::no_run(id),
            E::NoModel(id) => LabError::no_model(id),
            _ if error.is_not_found() => LabError::NotFound(message),
            _ if error.is_setup() => LabError::Setup(message),
            E::OtherRun { .. } | E::Search { .. } | E::Order { .. } | E::TokenExists(_) => LabError::Invalid(message),
            E::RunOver { .. } | E::EffectUsed { .. } => LabError::Conflict(message),
            E::Dropped { .. } => LabError::Gone(message),
            E::Held | E::DiskFull => LabError::Busy(message),
            _ => LabError::Internal(message),
        }
    }
}

impl From<crate::bench::BenchError> for LabError {
    fn from(error: crate::bench::BenchError) -> Self {
        use crate::bench::BenchError as E;
        let message = error.to_string();
        match error {
            E::Busy(_) => LabError::Conflict(message),
            E::Instrument(_) => LabError::Bench(message),
            E::NoServo(_) => LabError::Invalid(message),
        }
    }
}

impl From<crate::view::ConversionError> for LabError {
    fn from(error: crate::view::ConversionError) -> Self {
        LabError::Internal(error.to_string())
    }
}

impl From<jointbench_files::FileError> for LabError {
    fn from(error: jointbench_files::FileError) -> Self {
        let column = error.column().map(str::to_owned);
        let line = error.place.line.or(error.place.row);
        if error.is_io() {
            return LabError::Setup(error.to_string());
        }
        LabError::File { detail: error.to_string(), line, column }
    }
}

impl From<jointbench_files::OptionFault> for LabError {
    fn from(error: jointbench_files::OptionFault) -> Self {
        LabError::Invalid(error.to_string())
    }
}

impl From<jointbench_model::ModelError> for LabError {
    fn from(error: jointbench_model::ModelError) -> Self {
        match error {
            jointbench_model::ModelError::Formula(fault) => LabError::Formula(fault),
            error => LabError::Invalid(error.to_string()),
        }
    }
}

impl From<jointbench_procedure::PlanFault> for LabError {
    fn from(error: jointbench_procedure::PlanFault) -> Self {
        LabError::Invalid(error.to_string())
    }
}

impl From<jointbench_instrument::TableFault> for LabError {
    fn from(error: jointbench_instrument::TableFault) -> Self {
        LabError::Invalid(format!("this run cannot be modelled: {error}"))
    }
}

impl From<crate::config::ConfigErrors> for LabError {
    fn from(errors: crate::config::ConfigErrors) -> Self {
        let line = errors.errors.first().and_then(|error| error.line).map(|line| line as u64);
        LabError::File { detail: errors.to_string(), line, column: None }
    }
}
