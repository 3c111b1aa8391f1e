//! Errors of an archive.

use crate::config::S3;
use crate::error::LabError;
use std::error::Error;

/// The fault with its cause: `object_store` names only the operation.
pub fn unavailable(folder: &str, fault: &dyn Error) -> LabError {
    let mut text = format!("the archive {folder} is not available: {fault}");
    let mut cause = fault.source();
    while let Some(fault) = cause {
        let why = fault.to_string();
        if !text.contains(&why) {
            text += &format!(": {why}");
        }
        cause = fault.source();
    }
    LabError::Busy(if folder.starts_with(S3) { without_keys(&text) } else { text })
}

/// The error of a request with only the message of its answer (XML), which may also contain keys of the request.
fn without_keys(text: &str) -> String {
    let Some((error, answer)) = text.split_once('<') else { return text.to_owned() };
    let message = answer.split_once("<Message>").and_then(|(_, rest)| rest.split_once("</Message>"));
    format!("{error}{}", message.map_or("", |(message, _)| message))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_request_has_no_keys() {
        let answer = "403 Forbidden: <?xml version=\"1.0\"?>\n<Error><Code>InvalidToken</Code><Message>The token is \
            malformed.</Message><Token-0>FwoGZXIvYXdzE</Token-0></Error>";
        assert_eq!(without_keys(answer), "403 Forbidden: The token is malformed.");
        assert_eq!(without_keys("502 Bad Gateway: <html>proxy</html>"), "502 Bad Gateway: ");
        assert_eq!(without_keys("/srv: no space left"), "/srv: no space left");
    }
}
