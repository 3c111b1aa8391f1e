//! What is wrong with a formula, and where.

use std::ops::Range;

/// A mistake at a character of a text that a user wrote.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("effect {effect}: {message} ({field}, character {})", .position + 1)]
pub struct FormulaFault {
    pub effect: String,
    /// `formula`, or the part of the definition that is wrong.
    pub field: String,
    /// What `position` counts in.
    pub text: String,
    /// Characters before the mistake.
    pub position: usize,
    /// Characters of the mistake; 0 where something is missing.
    pub length: usize,
    /// What is wrong and what to write instead.
    pub message: String,
}

impl FormulaFault {
    /// The line of the mistake with another below it that points at its characters.
    pub fn marked(&self) -> String {
        let before: String = self.text.chars().take(self.position).collect();
        let start = before.rfind('\n').map_or(0, |end| end + 1);
        let line = self.text[start..].lines().next().unwrap_or_default();
        let blank: String = before[start..].chars().map(|c| if c == '\t' { c } else { ' ' }).collect();
        format!("{line}\n{blank}{}", "^".repeat(self.length.max(1)))
    }
}

/// A mistake in a text that is being read: bytes, as parsers count.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mistake {
    pub at: Range<usize>,
    pub message: String,
}

impl Mistake {
    pub fn new(at: Range<usize>, message: impl Into<String>) -> Self {
        Self { at, message: message.into() }
    }

    pub fn found(self, effect: &str, field: &str, text: &str) -> FormulaFault {
        let characters = |range: Range<usize>| text.get(range).map_or(0, |part| part.chars().count());
        FormulaFault {
            effect: effect.to_owned(),
            field: field.to_owned(),
            text: text.to_owned(),
            position: characters(0..self.at.start),
            length: characters(self.at),
            message: self.message,
        }
    }
}
