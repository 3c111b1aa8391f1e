//! MQTT 3.1.1: one connection for each message, which is delivered when the broker has acknowledged it (QoS 1).

use crate::config::Server;
use rumqttc::{AsyncClient, Event, MqttOptions, Packet, QoS};

/// Larger than any message.
const MOST_BYTES: usize = 1 << 18;

pub async fn publish(server: &Server, topic: &str, body: &str) -> Result<(), String> {
    let id = format!("jointbench-{:08x}", rand::random::<u32>());
    let mut options = MqttOptions::new(id, &server.host, server.port);
    options.set_max_packet_size(MOST_BYTES, MOST_BYTES);
    if let Some((user, password)) = &server.login {
        options.set_credentials(user, password.reveal());
    }
    let (client, mut events) = AsyncClient::new(options, 2);
    client.publish(topic, QoS::AtLeastOnce, false, body).await.map_err(|fault| fault.to_string())?;
    while !matches!(events.poll().await.map_err(|fault| fault.to_string())?, Event::Incoming(Packet::PubAck(_))) {}
    // The message is delivered, with or without an orderly end of the connection.
    drop(client.disconnect().await);
    drop(events.poll().await);
    Ok(())
}
