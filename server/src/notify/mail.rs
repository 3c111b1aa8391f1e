//! Mail: a plain text with the facts of the message.

use super::LIMIT;
use crate::config::Server;
use crate::view::{Notification, spoken};
use lettre::message::header::ContentType;
use lettre::message::{Mailbox, Message};
use lettre::transport::smtp::authentication::Credentials;
use lettre::transport::smtp::client::{Tls, TlsParameters};
use lettre::{SmtpTransport, Transport};

pub fn send(to: Mailbox, from: Mailbox, server: &Server, message: &Notification) -> Result<(), String> {
    let mail = Message::builder()
        .to(to)
        .from(from)
        // A repeated delivery has the same id.
        .message_id(Some(format!("<{}@jointbench>", message.id)))
        .subject(subject(message))
        .header(ContentType::TEXT_PLAIN)
        .body(text(message))
        .map_err(|fault| fault.to_string())?;
    transport(server)?.send(&mail).map(drop).map_err(|fault| fault.to_string())
}

/// A password is never sent unencrypted. Without a password, encryption is used if the server offers it.
fn transport(server: &Server) -> Result<SmtpTransport, String> {
    let parameters = TlsParameters::new(server.host.clone()).map_err(|fault| fault.to_string())?;
    let tls = match (server.tls, &server.login) {
        (true, _) => Tls::Wrapper(parameters),
        (false, Some(_)) => Tls::Required(parameters),
        (false, None) => Tls::Opportunistic(parameters),
    };
    let mut transport = SmtpTransport::builder_dangerous(&server.host).port(server.port).tls(tls).timeout(Some(LIMIT));
    if let Some((user, password)) = &server.login {
        transport = transport.credentials(Credentials::new(user.clone(), password.reveal().to_owned()));
    }
    Ok(transport.build())
}

fn subject(message: &Notification) -> String {
    let bench = message.bench.as_ref().map(|bench| format!(" {bench}:")).unwrap_or_default();
    let run = message.run.map(|run| format!(" run {run}")).unwrap_or_default();
    let verdict = message.verdict.map(|verdict| format!(", {}", spoken(verdict))).unwrap_or_default();
    format!("[jointbench]{bench}{run} {}{verdict}", event(&message.event))
}

fn text(message: &Notification) -> String {
    let facts = [
        ("Event", Some(event(&message.event))),
        ("Time", Some(message.time.clone())),
        ("Bench", message.bench.clone()),
        ("Run", message.run.map(|run| run.to_string())),
        ("Procedure", message.procedure.clone()),
        ("Unit under test", message.unit.clone()),
        ("State", message.state.map(spoken)),
        ("Verdict", message.verdict.map(spoken)),
        ("Limits", message.limits.map(spoken)),
        ("Link", message.link.clone()),
    ];
    let facts = facts.into_iter().filter_map(|(name, value)| Some(format!("{name}: {}\n", value?)));
    format!("{}.\n\n{}", message.summary, facts.collect::<String>())
}

fn event(word: &str) -> String {
    match word {
        "needs_hand" => "needs a person".to_owned(),
        word => spoken(word),
    }
}
