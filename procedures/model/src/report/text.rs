//! Texts in which the ids of effects are marked, so that a page can show their titles.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A part of a text.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TextPart {
    /// Words.
    Text(String),
    /// Id of an effect.
    Effect(String),
}

/// Sign before and after the id of an effect while a text is written: of the private use area of Unicode, so that no
/// name in a run contains it.
const MARK: char = '\u{E000}';

/// An effect in a text.
pub(crate) fn marked(effect: &str) -> String {
    format!("{MARK}{effect}{MARK}")
}

/// Several effects in a text.
pub(crate) fn all_marked(effects: &[impl AsRef<str>]) -> Vec<String> {
    effects.iter().map(|effect| marked(effect.as_ref())).collect()
}

/// The text without marks.
pub(crate) fn plain(text: &str) -> String {
    text.replace(MARK, "")
}

/// The words and the effects of a text.
pub(crate) fn parts(text: &str) -> Vec<TextPart> {
    let part = |(place, part): (usize, &str)| match place % 2 {
        0 => TextPart::Text(part.to_owned()),
        _ => TextPart::Effect(part.to_owned()),
    };
    text.split(MARK).enumerate().filter(|(_, part)| !part.is_empty()).map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_are_parts_of_a_text() {
        let text = format!("Missing effect: {}. Adding {} helps.", marked("viscous"), marked("viscous"));
        assert_eq!(plain(&text), "Missing effect: viscous. Adding viscous helps.");
        let [head, effect, ..] = &parts(&text)[..] else { panic!("{text}") };
        assert_eq!(*head, TextPart::Text("Missing effect: ".into()));
        assert_eq!(*effect, TextPart::Effect("viscous".into()));
        assert_eq!(parts(""), []);
    }
}
