//! Errors in a bench description: line and remedy.

use std::fmt;
use std::ops::Range;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mistake {
    /// Counted from 1.
    pub line: usize,
    /// The error, then the remedy.
    pub what: String,
}

/// All errors of one file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mistakes {
    pub file: String,
    pub mistakes: Vec<Mistake>,
}

impl fmt::Display for Mistakes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, mistake) in self.mistakes.iter().enumerate() {
            let end = if i + 1 < self.mistakes.len() { "\n" } else { "" };
            write!(f, "{}, line {}: {}{end}", self.file, mistake.line, mistake.what)?;
        }
        Ok(())
    }
}

impl std::error::Error for Mistakes {}

/// Collects errors during a check, so that one check reports all of them.
pub(super) struct Collector<'a> {
    text: &'a str,
    mistakes: Vec<Mistake>,
}

impl<'a> Collector<'a> {
    pub fn new(text: &'a str) -> Self {
        Self { text, mistakes: Vec::new() }
    }

    pub fn add(&mut self, span: Range<usize>, what: impl Into<String>) {
        let line = self.text[..span.start.min(self.text.len())].matches('\n').count() + 1;
        self.mistakes.push(Mistake { line, what: what.into() });
    }

    pub fn finish<T>(mut self, file: &str, checked: Option<T>) -> Result<T, Mistakes> {
        self.mistakes.sort_by_key(|mistake| mistake.line);
        match checked {
            Some(checked) if self.mistakes.is_empty() => Ok(checked),
            _ => Err(Mistakes { file: file.to_owned(), mistakes: self.mistakes }),
        }
    }
}
