//! Delivery of one message to one target. Each attempt has a time limit; `lab::notifications` decides about the next one.

mod mail;
mod mqtt;
mod webhook;

use crate::config::Channel;
use crate::view::Notification;
use std::time::Duration;
use tokio::time::timeout;

/// Time limit of an attempt; for mail, of each exchange with the server.
const LIMIT: Duration = Duration::from_secs(10);

/// Delivers `body`, the JSON of a [`Notification`].
///
/// # Errors
/// Why the target does not have the message, without secrets.
pub async fn deliver(channel: &Channel, body: &str) -> Result<(), String> {
    let message: Notification = serde_json::from_str(body).map_err(|fault| fault.to_string())?;
    match channel.clone() {
        Channel::Webhook { url, key } => {
            let body = body.to_owned();
            blocking(move || webhook::post(&url, key.as_ref(), &message.id, &body)).await
        }
        Channel::Mail { to, from, server } => blocking(move || mail::send(to, from, &server, &message)).await,
        Channel::Mqtt { server, topic } => {
            let published = timeout(LIMIT, mqtt::publish(&server, &topic, body)).await;
            published.unwrap_or_else(|_| Err(format!("no answer within {} s", LIMIT.as_secs())))
        }
    }
}

async fn blocking(send: impl FnOnce() -> Result<(), String> + Send + 'static) -> Result<(), String> {
    tokio::task::spawn_blocking(send).await.unwrap_or_else(|fault| Err(fault.to_string()))
}
