//! Cancels a long computation when its client disconnects.

use super::presence::Presence;
use super::problem::Problem;
use crate::lab::LabError;
use serde::Deserialize;
use utoipa::IntoParams;

#[derive(Debug, Clone, Copy, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct DetachQuery {
    /// The computation continues when the client disconnects, and its result is stored.
    pub detach: bool,
}

/// Returns the result of a computation. Cancels it when the client disconnects, unless it is detached.
pub async fn cancel_on_disconnect<T: Send + 'static>(
    presence: Presence,
    query: DetachQuery,
    work: impl Future<Output = Result<T, LabError>> + Send + 'static,
) -> Result<T, Problem> {
    if query.detach {
        let done = tokio::spawn(work).await;
        return Ok(done.map_err(|fault| LabError::Internal(format!("the computation failed: {fault}")))??);
    }
    tokio::select! {
        done = work => Ok(done?),
        // No client receives this answer.
        () = presence.gone() => Err(LabError::Over("the client disconnected: the computation was cancelled".into()).into()),
    }
}
