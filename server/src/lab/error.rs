//! Every way in which the lab refuses, and which one to use where.
//!
//! * [`LabError::NotFound`]: what was named is not there.
//! * [`LabError::Invalid`]: the request is understood, but its values make no sense here; say what to do instead.
//! * [`LabError::File`]: a measurement file or description was refused; carries file, line and column where known.
//! * [`LabError::Formula`]: a user's effect is wrong at a character.
//! * [`LabError::Conflict`]: right request, wrong moment (bench busy, bench blocked).
//! * [`LabError::Busy`]: nothing is wrong with the request; the same may work in a moment (disk full, database held, too many
//!   computations at once).
//! * [`LabError::Over`]: too late for ever, whatever is waited for (a run that has ended, or was gone on with).
//! * [`LabError::Bench`]: an instrument does not do what it should.
//! * [`LabError::TooLarge`]: it needs more memory or time than it may have.
//! * [`LabError::Setup`]: the daemon cannot start as it was asked to (port taken, folder unwritable, old database).
//! * [`LabError::Internal`]: ours; the detail goes to the log as well.
//!
//! `api::problem` decides what each means in HTTP, [`LabError::exit_code`] what it means to a shell.

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

    /// 0 done, 1 the run failed or a limit was broken, 2 bad arguments or bad input, 3 could not be decided.
    pub fn exit_code(&self) -> u8 {
        match self {
            LabError::Conflict(_) | LabError::Busy(_) | LabError::Bench(_) | LabError::Internal(_) => 1,
            LabError::NotFound(_)
            | LabError::Over(_)
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
        let said = error.to_string();
        match error {
            E::NoRun(id) => LabError::no_run(id),
            E::NoModel(id) => LabError::no_model(id),
            _ if error.is_not_found() => LabError::NotFound(said),
            _ if error.is_setup() => LabError::Setup(said),
            E::OtherRun { .. } | E::Search { .. } | E::Order { .. } | E::TokenExists(_) => LabError::Invalid(said),
            E::RunOver { .. } | E::EffectUsed { .. } => LabError::Conflict(said),
            E::Held | E::DiskFull => LabError::Busy(said),
            _ => LabError::Internal(said),
        }
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

impl From<crate::config::Mistakes> for LabError {
    fn from(mistakes: crate::config::Mistakes) -> Self {
        let line = mistakes.mistakes.first().map(|mistake| mistake.line as u64);
        LabError::File { detail: mistakes.to_string(), line, column: None }
    }
}
