//! Long computations and the clients who wait for them, or no longer do.

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

/// The result of a computation for whoever waits for it. When the client leaves it is given up, unless it is to go on.
pub async fn waited_for<T: Send + 'static>(
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
        // Nobody reads this answer.
        () = presence.gone() => Err(LabError::Over("the client disconnected: the computation was cancelled".into()).into()),
    }
}
