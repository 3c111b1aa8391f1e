//! Why a command ends without a result.

use datafusion::error::DataFusionError;

/// A fault with its exit code.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// Arguments or files are wrong: exit code 2.
    #[error("{0}")]
    Input(String),
    /// The computation failed: exit code 1.
    #[error("{0}")]
    Failed(String),
}

impl Fault {
    /// Exit code, as in the main program: 1 for a failure, 2 for invalid arguments or input.
    pub fn exit_code(&self) -> u8 {
        match self {
            Fault::Input(_) => 2,
            Fault::Failed(_) => 1,
        }
    }
}

impl From<DataFusionError> for Fault {
    /// A wrong query is input; everything else is a failure.
    fn from(error: DataFusionError) -> Self {
        let text = error.strip_backtrace();
        match error.find_root() {
            DataFusionError::SQL(..) | DataFusionError::Plan(_) | DataFusionError::SchemaError(..) => {
                Fault::Input(text)
            }
            _ => Fault::Failed(text),
        }
    }
}
