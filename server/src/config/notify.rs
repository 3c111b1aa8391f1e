//! Targets of notifications: webhooks, mail and MQTT.

use super::error::Collector;
use super::raw::RawNotify;
use super::secret::{Secret, read_secret};
use super::values::choice;
use axum::http::Uri;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use lettre::message::Mailbox;
use percent_encoding::percent_decode_str;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use utoipa::ToSchema;

const LONGEST_NAME: usize = 120;
/// Begins a signing key that is written in Base64, as in Standard Webhooks.
const ENCODED_KEY: &str = "whsec_";

/// What a person or a script may want to know.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum NotifyEvent {
    /// A run is complete, or ended on request.
    Finished,
    /// A run ended by a limit, a fault or an interruption.
    Failed,
    /// The safe state of a bench is not confirmed.
    Unsafe,
    /// A bench, a queue or a run waits for a person.
    NeedsHand,
}

const EVENTS: [(&str, NotifyEvent); 4] = [
    ("finished", NotifyEvent::Finished),
    ("failed", NotifyEvent::Failed),
    ("unsafe", NotifyEvent::Unsafe),
    ("needs_hand", NotifyEvent::NeedsHand),
];

/// The notifications of a bench description.
#[derive(Debug, Clone, Default)]
pub struct Notify {
    /// Address of the dashboard in links, if it is not that of the listener.
    pub dashboard: Option<String>,
    pub targets: Vec<NotifyTarget>,
}

/// One receiver of messages.
#[derive(Debug, Clone)]
pub struct NotifyTarget {
    /// Unique; it contains no secret.
    pub name: String,
    pub events: Vec<NotifyEvent>,
    pub channel: Channel,
}

/// How a message reaches its target.
#[derive(Debug, Clone)]
pub enum Channel {
    /// The address may contain a secret.
    Webhook {
        url: Secret,
        key: Option<SigningKey>,
    },
    Mail {
        to: Mailbox,
        from: Mailbox,
        server: Server,
    },
    Mqtt {
        server: Server,
        topic: String,
    },
}

impl Channel {
    pub fn kind(&self) -> &'static str {
        match self {
            Channel::Webhook { .. } => "webhook",
            Channel::Mail { .. } => "mail",
            Channel::Mqtt { .. } => "mqtt",
        }
    }
}

/// The bytes that sign a webhook.
#[derive(Clone)]
pub struct SigningKey(pub Vec<u8>);

impl std::fmt::Debug for SigningKey {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("SigningKey(…)")
    }
}

/// A mail server or a broker.
#[derive(Debug, Clone)]
pub struct Server {
    pub host: String,
    pub port: u16,
    /// Encrypted from the first byte.
    pub tls: bool,
    /// User and password.
    pub login: Option<(String, Secret)>,
}

/// Checks every target. `file`: the description, whose folder contains the files of secrets.
pub fn check_targets(file: &str, raw: &[Spanned<RawNotify>], wrong: &mut Collector) -> Option<Vec<NotifyTarget>> {
    let mut names: Vec<String> = Vec::new();
    let checked: Vec<_> = raw.iter().map(|given| check_target(file, given, &mut names, wrong)).collect();
    checked.into_iter().collect()
}

fn check_target(
    file: &str,
    given: &Spanned<RawNotify>,
    names: &mut Vec<String>,
    wrong: &mut Collector,
) -> Option<NotifyTarget> {
    let (raw, place) = (given.get_ref(), given.span());
    let secret = secret(file, raw, wrong);
    let events = events(raw, &place, wrong);
    foreign_keys(raw, wrong);
    let (address, channel) = match (&raw.webhook, &raw.mail, &raw.mqtt) {
        (Some(webhook), None, None) => check_webhook(webhook, secret?, wrong)?,
        (None, Some(mail), None) => check_mail(mail, raw, &place, secret?, wrong)?,
        (None, None, Some(mqtt)) => check_mqtt(mqtt, raw, &place, secret?, wrong)?,
        _ => {
            wrong.add(place, "[[notify]] has one target: give webhook, mail or mqtt");
            return None;
        }
    };
    let name = raw.name.as_ref().map_or(address, |name| name.get_ref().trim().to_owned());
    let name_place = raw.name.as_ref().map_or(place, Spanned::span);
    if name.is_empty() || name.len() > LONGEST_NAME || name.chars().any(char::is_control) {
        wrong.add(name_place, format!("name: use 1 to {LONGEST_NAME} characters in one line"));
        return None;
    }
    if names.contains(&name) {
        wrong.add(name_place, format!("target {name:?} exists twice: give each [[notify]] its own name"));
        return None;
    }
    names.push(name.clone());
    Some(NotifyTarget { name, events: events?, channel })
}

/// Each event once; all events if none are given.
fn events(raw: &RawNotify, place: &Range<usize>, wrong: &mut Collector) -> Option<Vec<NotifyEvent>> {
    let all = EVENTS.map(|(_, event)| event);
    let Some(given) = &raw.events else { return Some(all.into()) };
    if given.is_empty() {
        wrong.add(place.clone(), "events is empty: name at least one, or remove it for all events");
    }
    let chosen: Vec<_> = given.iter().map(|event| choice(event, "event", &EVENTS, wrong)).collect();
    let chosen: Vec<NotifyEvent> = chosen.into_iter().collect::<Option<_>>()?;
    Some(all.into_iter().filter(|event| chosen.contains(event)).collect())
}

/// Reports keys that belong to another kind of target.
fn foreign_keys(raw: &RawNotify, wrong: &mut Collector) {
    for (key, given, owner, owned) in [
        ("smtp", &raw.smtp, "mail", raw.mail.is_some()),
        ("from", &raw.from, "mail", raw.mail.is_some()),
        ("topic", &raw.topic, "mqtt", raw.mqtt.is_some()),
    ] {
        if let Some(given) = given.as_ref().filter(|_| !owned) {
            wrong.add(given.span(), format!("{key} belongs to {owner}: remove it"));
        }
    }
}

/// `Some(None)` without a secret, `None` if it cannot be read.
fn secret(file: &str, raw: &RawNotify, wrong: &mut Collector) -> Option<Option<Secret>> {
    let (place, found) = match (&raw.secret_file, &raw.secret_env) {
        (None, None) => return Some(None),
        (Some(given), None) => {
            let path = Path::new(file).with_file_name(given.get_ref());
            (given.span(), read_secret(&path).map_err(|why| format!("secret_file {}: {why}", path.display())))
        }
        (None, Some(given)) => {
            let variable = given.get_ref();
            let value = std::env::var(variable).ok().filter(|value| !value.is_empty());
            (given.span(), value.ok_or_else(|| format!("secret_env {variable} is not set: set the variable")))
        }
        (Some(_), Some(given)) => {
            (given.span(), Err("secret_file and secret_env are both given: remove one of them".into()))
        }
    };
    match found {
        Ok(secret) => Some(Some(Secret::new(secret))),
        Err(why) => {
            wrong.add(place, why);
            None
        }
    }
}

fn check_webhook(given: &Spanned<String>, secret: Option<Secret>, wrong: &mut Collector) -> Option<(String, Channel)> {
    let url = given.get_ref().trim();
    let uri: Option<Uri> = url.parse().ok();
    let parts = uri.as_ref().and_then(|uri| Some((uri.scheme_str()?, uri.authority()?)));
    let Some((scheme, authority)) = parts.filter(|(scheme, _)| ["http", "https"].contains(scheme)) else {
        wrong.add(given.span(), "webhook is not an address: write https://host/path");
        return None;
    };
    if authority.as_str().contains('@') {
        wrong.add(given.span(), "webhook contains a user: remove it, and sign the messages with secret_file");
        return None;
    }
    let key = match secret.as_ref().map(|secret| signing_key(secret.reveal())) {
        Some(None) => {
            let cure = format!("write Base64 after {ENCODED_KEY}, or another text without it");
            wrong.add(given.span(), format!("the secret of the webhook cannot be decoded: {cure}"));
            return None;
        }
        key => key.flatten(),
    };
    Some((format!("{scheme}://{authority}"), Channel::Webhook { url: Secret::new(url), key }))
}

fn signing_key(secret: &str) -> Option<SigningKey> {
    match secret.strip_prefix(ENCODED_KEY) {
        Some(encoded) => STANDARD.decode(encoded).ok().map(SigningKey),
        None => Some(SigningKey(secret.as_bytes().to_vec())),
    }
}

fn check_mail(
    given: &Spanned<String>,
    raw: &RawNotify,
    place: &Range<usize>,
    secret: Option<Secret>,
    wrong: &mut Collector,
) -> Option<(String, Channel)> {
    let (to, from) = (mailbox(given, "mail", wrong), raw.from.as_ref().map(|from| mailbox(from, "from", wrong)));
    let server = raw.smtp.as_ref().map(|smtp| server(smtp, "smtp", &SMTP, secret, wrong));
    for (key, missing) in [("smtp, such as smtps://user@host", server.is_none()), ("from", from.is_none())] {
        if missing {
            wrong.add(place.clone(), format!("mail needs {key}: add it"));
        }
    }
    let (to, from, server) = (to?, from??, server??);
    Some((to.email.to_string(), Channel::Mail { to, from, server }))
}

fn mailbox(given: &Spanned<String>, key: &str, wrong: &mut Collector) -> Option<Mailbox> {
    let parsed = given.get_ref().parse();
    if parsed.is_err() {
        wrong.add(given.span(), format!("{key} {:?}: write a mail address, such as lab@example.org", given.get_ref()));
    }
    parsed.ok()
}

fn check_mqtt(
    given: &Spanned<String>,
    raw: &RawNotify,
    place: &Range<usize>,
    secret: Option<Secret>,
    wrong: &mut Collector,
) -> Option<(String, Channel)> {
    let server = server(given, "mqtt", &MQTT, secret, wrong);
    let Some(topic) = &raw.topic else {
        wrong.add(place.clone(), "mqtt needs topic: add it");
        return None;
    };
    let text = topic.get_ref();
    if text.is_empty() || text.len() > usize::from(u16::MAX) || text.contains(['+', '#', '\0']) {
        wrong.add(topic.span(), format!("topic {text:?}: write the name of one topic, without + and #"));
        return None;
    }
    let server = server?;
    Some((format!("mqtt://{}:{}/{text}", server.host, server.port), Channel::Mqtt { server, topic: text.clone() }))
}

/// Schemes with their ports, and whether they are encrypted.
type Schemes = [(&'static str, u16, bool)];

const SMTP: [(&str, u16, bool); 2] = [("smtps", 465, true), ("smtp", 587, false)];
const MQTT: [(&str, u16, bool); 1] = [("mqtt", 1883, false)];

/// An address `scheme://user@host:port`, whose password is the secret.
fn server(
    given: &Spanned<String>,
    key: &str,
    schemes: &Schemes,
    secret: Option<Secret>,
    wrong: &mut Collector,
) -> Option<Server> {
    let uri: Option<Uri> = given.get_ref().trim().parse().ok();
    let parts = uri.as_ref().and_then(|uri| {
        let (_, port, tls) = schemes.iter().find(|(scheme, ..)| uri.scheme_str() == Some(scheme))?;
        Some((uri.authority()?, *port, *tls))
    });
    let Some((authority, port, tls)) = parts else {
        let forms: Vec<String> = schemes.iter().map(|(scheme, ..)| format!("{scheme}://user@host:port")).collect();
        wrong.add(given.span(), format!("{key} is not an address: write {}", forms.join(" or ")));
        return None;
    };
    let user = authority.as_str().rsplit_once('@').map(|(user, _)| user);
    if user.is_some_and(|user| user.contains(':')) {
        wrong.add(given.span(), format!("{key} contains a password: remove it, and give secret_file or secret_env"));
        return None;
    }
    let user = user.map(|user| percent_decode_str(user).decode_utf8_lossy().into_owned());
    let login = match (user, secret) {
        (Some(user), Some(password)) => Some((user, password)),
        (None, None) => None,
        (Some(_), None) => {
            wrong.add(given.span(), format!("{key} has a user without a password: give secret_file or secret_env"));
            return None;
        }
        (None, Some(_)) => {
            wrong.add(given.span(), format!("{key} has a password without a user: write user@ before the host"));
            return None;
        }
    };
    let host = authority.host().trim_matches(['[', ']']).to_owned();
    Some(Server { host, port: authority.port_u16().unwrap_or(port), tls, login })
}

/// The address of the dashboard in links, without a slash at its end.
pub fn check_dashboard(given: &Spanned<String>, wrong: &mut Collector) -> Option<String> {
    let address = given.get_ref().trim().trim_end_matches('/');
    let uri: Option<Uri> = address.parse().ok();
    if !uri.is_some_and(|uri| ["http", "https"].contains(&uri.scheme_str().unwrap_or_default())) {
        wrong.add(given.span(), "dashboard is not an address: write https://host:port");
        return None;
    }
    Some(address.to_owned())
}
