//! Targets of notifications, from the bench description.

use super::extract::{Answer, Json};
use super::refusals::Refusals;
use crate::lab::{Caller, Lab};
use crate::view::{NotificationTarget, NotificationTest};
use axum::Extension;
use axum::extract::State;

/// The targets of notifications with their waiting messages, without secrets
#[utoipa::path(get, path = "/notifications", operation_id = "list_notifications", tag = "daemon",
    responses((status = 200, description = "The targets", body = Vec<NotificationTarget>), Refusals))]
pub async fn list(State(lab): State<Lab>) -> Answer<Vec<NotificationTarget>> {
    Ok(Json(lab.notification_targets().await?))
}

/// Sends a test message to each target
#[utoipa::path(post, path = "/notifications/test", operation_id = "test_notifications", tag = "daemon",
    responses((status = 200, description = "The outcome for each target", body = Vec<NotificationTest>), Refusals))]
pub async fn test(State(lab): State<Lab>, Extension(caller): Extension<Caller>) -> Answer<Vec<NotificationTest>> {
    Ok(Json(lab.test_notifications(&caller.name).await?))
}
