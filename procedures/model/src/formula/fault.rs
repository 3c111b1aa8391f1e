//! Errors in a formula, with their position.

use std::ops::Range;

/// An error at a character of a user's text, with all other errors of the same text.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}{message} ({field}, character {}){}", whose(.effect), .position + 1, more(.also))]
pub struct FormulaFault {
    /// Id of the effect; empty for a formula without an effect.
    pub effect: String,
    /// `formula`, or the part of the definition that contains the error.
    pub field: &'static str,
    /// The text that `position` refers to.
    pub text: String,
    /// Characters before the error.
    pub position: usize,
    /// Length of the error in characters; 0 if something is missing.
    pub length: usize,
    /// The error, and what to write instead.
    pub message: String,
    /// Further errors of the same text, so that all can be corrected at once.
    pub also: Box<[FurtherFault]>,
}

/// A further error of a text.
#[derive(Debug, Clone, PartialEq)]
pub struct FurtherFault {
    /// Characters before the error, in the same text.
    pub position: usize,
    /// Length of the error in characters; 0 if something is missing.
    pub length: usize,
    /// The error, and what to write instead.
    pub message: String,
}

fn whose(effect: &str) -> String {
    if effect.is_empty() { String::new() } else { format!("effect {effect}: ") }
}

fn more(also: &[FurtherFault]) -> String {
    also.iter().map(|a| format!("\n  and {} (character {})", a.message, a.position + 1)).collect()
}

impl FormulaFault {
    /// The error relative to a longer text, in which this text starts after `start` characters.
    pub(crate) fn within(mut self, text: &str, start: usize) -> Self {
        text.clone_into(&mut self.text);
        self.position += start;
        self.also.iter_mut().for_each(|a| a.position += start);
        self
    }

    /// The line of the first error, and a line below it that marks all errors in it.
    pub fn marked(&self) -> String {
        let before: String = self.text.chars().take(self.position).collect();
        let start = before.rfind('\n').map_or(0, |end| end + 1);
        let line = self.text[start..].lines().next().unwrap_or_default();
        let first = before[..start].chars().count();
        let all =
            || std::iter::once((self.position, self.length)).chain(self.also.iter().map(|a| (a.position, a.length)));
        let is_marked = |at: usize| all().any(|(position, length)| (position..position + length.max(1)).contains(&at));
        // One more character for something that is missing at the end.
        let below = line.chars().chain([' ']).enumerate().map(|(i, c)| match (is_marked(first + i), c) {
            (true, _) => '^',
            (false, '\t') => '\t',
            (false, _) => ' ',
        });
        format!("{line}\n{}", below.collect::<String>().trim_end())
    }
}

/// An error in a text that is being parsed, with byte positions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mistake {
    pub at: Range<usize>,
    pub message: String,
    pub also: Vec<Mistake>,
}

impl Mistake {
    pub fn new(at: Range<usize>, message: impl Into<String>) -> Self {
        Self { at, message: message.into(), also: Vec::new() }
    }

    /// The first of several errors, which carries the others. `None` without errors.
    pub fn first_of(mut all: Vec<Mistake>) -> Option<Self> {
        (!all.is_empty()).then(|| {
            let mut first = all.remove(0);
            first.also = all;
            first
        })
    }

    pub fn found(self, effect: &str, field: &'static str, text: &str) -> FormulaFault {
        let characters = |range: Range<usize>| text.get(range).map_or(0, |part| part.chars().count());
        let also = self.also.into_iter().map(|other| FurtherFault {
            position: characters(0..other.at.start),
            length: characters(other.at),
            message: other.message,
        });
        FormulaFault {
            effect: effect.to_owned(),
            field,
            text: text.to_owned(),
            position: characters(0..self.at.start),
            length: characters(self.at),
            message: self.message,
            also: also.collect(),
        }
    }
}
