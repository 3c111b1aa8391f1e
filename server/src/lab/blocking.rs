//! Computations outside of the threads that answer requests.

use super::{Answer, LabError};
use jointbench_model::ModelError;

/// Runs a long computation.
pub(super) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, ModelError> + Send + 'static,
) -> Answer<T> {
    match tokio::task::spawn_blocking(work).await {
        Ok(result) => Ok(result?),
        Err(fault) => Err(LabError::Internal(format!("the computation failed: {fault}"))),
    }
}
