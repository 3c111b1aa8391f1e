//! Exit code and message of a failed command.

use crate::lab::LabError;
use crate::view::ConversionError;
use jointbench_files::{FileError, OptionFault};
use jointbench_model::{FormulaFault, ModelError, words};
use std::path::Path;
use std::process::ExitCode;

#[derive(Debug, Clone)]
pub struct Exit {
    pub code: u8,
    /// Message for a person; empty if it is already printed.
    pub message: String,
}

pub type Done = Result<(), Exit>;

impl Exit {
    /// Adds the names of the files to a fault of the model.
    pub fn of(files: &[impl AsRef<Path>], fault: ModelError) -> Self {
        let exit = Exit::from(fault);
        let names: Vec<String> = files.iter().map(|file| file.as_ref().display().to_string()).collect();
        Exit { message: format!("{}: {}", words::list(&names), exit.message), ..exit }
    }

    /// Prints the message on standard error.
    pub fn print(&self) -> ExitCode {
        if !self.message.is_empty() {
            eprintln!("jointbench: {}", self.message);
        }
        ExitCode::from(self.code)
    }

    pub fn failed(message: impl Into<String>) -> Self {
        Self { code: 1, message: message.into() }
    }

    pub fn bad_input(message: impl Into<String>) -> Self {
        Self { code: 2, message: message.into() }
    }

    pub fn undecided(message: impl Into<String>) -> Self {
        Self { code: 3, message: message.into() }
    }
}

impl From<LabError> for Exit {
    fn from(error: LabError) -> Self {
        Self { code: error.exit_code(), message: error.to_string() }
    }
}

impl From<ConversionError> for Exit {
    fn from(error: ConversionError) -> Self {
        LabError::from(error).into()
    }
}

impl From<FileError> for Exit {
    fn from(error: FileError) -> Self {
        Exit::bad_input(error.to_string())
    }
}

impl From<OptionFault> for Exit {
    fn from(error: OptionFault) -> Self {
        Exit::bad_input(error.to_string())
    }
}

impl From<FormulaFault> for Exit {
    fn from(fault: FormulaFault) -> Self {
        let marked = fault.marked().replace('\n', "\n  ");
        Exit::bad_input(format!("{fault}\n  {marked}"))
    }
}

impl From<ModelError> for Exit {
    /// Errors in arguments or metadata are bad input; data without a clear result is undecided.
    fn from(error: ModelError) -> Self {
        use ModelError as E;
        let message = error.to_string();
        match error {
            E::Formula(fault) => Exit::from(*fault),
            E::TooFewSamples { .. } | E::NotVisible { .. } | E::Collinear { .. } | E::Constant { .. } => {
                Exit::undecided(message)
            }
            _ => Exit::bad_input(message),
        }
    }
}
