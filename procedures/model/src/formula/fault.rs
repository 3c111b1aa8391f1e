//! What is wrong with a formula, and where.

use std::ops::Range;

/// A mistake at a character of a text that a user wrote, with the others of the same text.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}{message} ({field}, character {}){}", whose(.effect), .position + 1, more(.also))]
pub struct FormulaFault {
    /// Whose formula it is; empty where it is that of no effect.
    pub effect: String,
    /// `formula`, or the part of the definition that is wrong.
    pub field: &'static str,
    /// What `position` counts in.
    pub text: String,
    /// Characters before the mistake.
    pub position: usize,
    /// Characters of the mistake; 0 where something is missing.
    pub length: usize,
    /// What is wrong and what to write instead.
    pub message: String,
    /// Further mistakes of the same text, so that they can be mended at once.
    pub also: Box<[Also]>,
}

/// A further mistake of a text.
#[derive(Debug, Clone, PartialEq)]
pub struct Also {
    pub position: usize,
    pub length: usize,
    pub message: String,
}

fn whose(effect: &str) -> String {
    if effect.is_empty() { String::new() } else { format!("effect {effect}: ") }
}

fn more(also: &[Also]) -> String {
    also.iter().map(|a| format!("\n  and {} (character {})", a.message, a.position + 1)).collect()
}

impl FormulaFault {
    /// The same of a text that this one begins in, after so many characters of it.
    pub(crate) fn within(mut self, text: &str, start: usize) -> Self {
        text.clone_into(&mut self.text);
        self.position += start;
        self.also.iter_mut().for_each(|a| a.position += start);
        self
    }

    /// The line of the first mistake with another below it that points at the characters of all that stand in it.
    pub fn marked(&self) -> String {
        let before: String = self.text.chars().take(self.position).collect();
        let start = before.rfind('\n').map_or(0, |end| end + 1);
        let line = self.text[start..].lines().next().unwrap_or_default();
        let first = before[..start].chars().count();
        let all =
            || std::iter::once((self.position, self.length)).chain(self.also.iter().map(|a| (a.position, a.length)));
        let is_marked = |at: usize| all().any(|(position, length)| (position..position + length.max(1)).contains(&at));
        // One more for what is missing at the end.
        let below = line.chars().chain([' ']).enumerate().map(|(i, c)| match (is_marked(first + i), c) {
            (true, _) => '^',
            (false, '\t') => '\t',
            (false, _) => ' ',
        });
        format!("{line}\n{}", below.collect::<String>().trim_end())
    }
}

/// A mistake in a text that is being read: bytes, as parsers count.
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

    /// The first of several, which carries the others. `None` where there are none.
    pub fn first_of(mut all: Vec<Mistake>) -> Option<Self> {
        (!all.is_empty()).then(|| {
            let mut first = all.remove(0);
            first.also = all;
            first
        })
    }

    pub fn found(self, effect: &str, field: &'static str, text: &str) -> FormulaFault {
        let characters = |range: Range<usize>| text.get(range).map_or(0, |part| part.chars().count());
        let also = self.also.into_iter().map(|other| Also {
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
