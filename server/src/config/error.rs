//! Errors in a bench description: line and remedy.

use std::fmt;
use std::ops::Range;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConfigError {
    /// Counted from 1; `None` for the whole file.
    pub line: Option<usize>,
    /// The error, then the remedy.
    pub what: String,
}

/// All errors of one file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConfigErrors {
    pub file: String,
    pub errors: Vec<ConfigError>,
}

impl fmt::Display for ConfigErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, error) in self.errors.iter().enumerate() {
            let end = if i + 1 < self.errors.len() { "\n" } else { "" };
            let place = error.line.map(|line| format!(", line {line}")).unwrap_or_default();
            write!(f, "{}{place}: {}{end}", self.file, error.what)?;
        }
        Ok(())
    }
}

impl std::error::Error for ConfigErrors {}

/// Collects errors during a check, so that one check reports all of them.
pub(super) struct Collector<'a> {
    text: &'a str,
    errors: Vec<ConfigError>,
}

impl<'a> Collector<'a> {
    pub fn new(text: &'a str) -> Self {
        Self { text, errors: Vec::new() }
    }

    pub fn add(&mut self, span: Range<usize>, what: impl Into<String>) {
        let line = self.text[..span.start.min(self.text.len())].matches('\n').count() + 1;
        self.errors.push(ConfigError { line: Some(line), what: what.into() });
    }

    pub fn finish<T>(mut self, file: &str, checked: Option<T>) -> Result<T, ConfigErrors> {
        self.errors.sort_by_key(|error| error.line);
        match checked {
            Some(checked) if self.errors.is_empty() => Ok(checked),
            _ => Err(ConfigErrors { file: file.to_owned(), errors: self.errors }),
        }
    }
}
