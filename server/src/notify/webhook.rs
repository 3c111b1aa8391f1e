//! Webhooks, signed as in Standard Webhooks (<https://www.standardwebhooks.com>): HMAC-SHA256 over id, time and body.

use super::LIMIT;
use crate::config::{Secret, SigningKey};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use jiff::Timestamp;
use ring::hmac;
use ureq::Agent;

pub fn post(url: &Secret, key: Option<&SigningKey>, id: &str, body: &str) -> Result<(), String> {
    let config = Agent::config_builder()
        .timeout_global(Some(LIMIT))
        .http_status_as_error(false)
        // A message that was sent on to another address would be signed for it.
        .max_redirects(0)
        .user_agent(concat!("jointbench/", env!("CARGO_PKG_VERSION")));
    let time_s = Timestamp::now().as_second();
    let mut request = Agent::new_with_config(config.build())
        .post(url.reveal())
        .header("content-type", "application/json")
        .header("webhook-id", id)
        .header("webhook-timestamp", time_s.to_string());
    if let Some(key) = key {
        request = request.header("webhook-signature", signature(key, id, time_s, body));
    }
    match request.send(body) {
        Ok(answer) if answer.status().is_success() => Ok(()),
        Ok(answer) => Err(format!("the receiver answered {}", answer.status())),
        // The message of a malformed address would contain the address.
        Err(ureq::Error::BadUri(_)) => Err("the address is malformed".into()),
        Err(fault) => Err(fault.to_string()),
    }
}

fn signature(key: &SigningKey, id: &str, time_s: i64, body: &str) -> String {
    let signed = hmac::sign(&hmac::Key::new(hmac::HMAC_SHA256, &key.0), format!("{id}.{time_s}.{body}").as_bytes());
    format!("v1,{}", STANDARD.encode(signed))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the specification of Standard Webhooks and its libraries.
    #[test]
    fn a_signature_is_that_of_the_specification() {
        let key = SigningKey(STANDARD.decode("MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw").unwrap());
        let signed = signature(&key, "msg_p5jXN8AQM9LWM0D4loKWxJek", 1_614_265_330, r#"{"test": 2432232314}"#);
        assert_eq!(signed, "v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE=");
    }
}
