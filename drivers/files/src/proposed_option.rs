//! Options that an import proposes: typed parts, and the same in command-line notation.

use crate::note::shell;
use serde::{Deserialize, Serialize};
use std::fmt;

/// One option by its name in a request, such as `unit`, and its value.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct OptionPart {
    pub name: String,
    /// `true` for an option without a value.
    pub value: String,
}

/// A proposal to the user: options to add, or an instruction in words.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct ProposedOption {
    /// In command-line notation, such as `--unit time_s=ms`, or in words.
    pub text: String,
    /// The options; empty for an instruction.
    pub parts: Vec<OptionPart>,
    /// Whether the options can be applied as they are. Otherwise a value is a placeholder, such as `HZ`.
    pub is_complete: bool,
}

impl ProposedOption {
    /// One option with its value.
    pub fn new(name: &str, value: impl Into<String>) -> Self {
        Self { is_complete: true, ..Self::default() }.and(name, value)
    }

    /// One option without a value.
    pub fn flag(name: &str) -> Self {
        Self { is_complete: true, ..Self::default() }.and_flag(name)
    }

    /// An option whose value the user has to replace.
    pub fn open(name: &str, value: impl Into<String>) -> Self {
        Self::default().and(name, value)
    }

    /// What to do, if no option does it.
    pub fn words(text: impl Into<String>) -> Self {
        Self { text: text.into(), ..Self::default() }
    }

    /// Adds an option with its value.
    pub fn and(self, name: &str, value: impl Into<String>) -> Self {
        let value = value.into();
        let text = format!("{} {}", flag(name), shell(&value));
        self.with_part(name, value, &text)
    }

    /// Adds an option without a value.
    pub fn and_flag(self, name: &str) -> Self {
        self.with_part(name, true.to_string(), &flag(name))
    }

    /// Adds the options of another proposal.
    pub fn and_all(mut self, other: Self) -> Self {
        self.text = [self.text, other.text].join(" ");
        self.parts.extend(other.parts);
        Self { is_complete: self.is_complete && other.is_complete, ..self }
    }

    /// The proposal with a value that the user has to replace.
    pub fn incomplete(self) -> Self {
        Self { is_complete: false, ..self }
    }

    fn with_part(mut self, name: &str, value: String, text: &str) -> Self {
        self.text = [&self.text, text].join(" ").trim_start().to_owned();
        self.parts.push(OptionPart { name: name.to_owned(), value });
        self
    }
}

/// `time_from_rate` → `--time-from-rate`.
fn flag(name: &str) -> String {
    format!("--{}", name.replace('_', "-"))
}

impl fmt::Display for ProposedOption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_option_is_written_as_on_the_command_line() {
        let both = ProposedOption::new("map", "time_s=Time [ms]").and("unit", "time_s=ms").and_flag("split_runs");
        assert_eq!(both.text, "--map 'time_s=Time [ms]' --unit time_s=ms --split-runs");
        let parts: Vec<_> = both.parts.iter().map(|part| (part.name.as_str(), part.value.as_str())).collect();
        assert_eq!(parts, [("map", "time_s=Time [ms]"), ("unit", "time_s=ms"), ("split_runs", "true")]);
        assert!(both.is_complete && !ProposedOption::open("rate", "HZ").is_complete);
        let all = ProposedOption::flag("split_runs").and_all(ProposedOption::open("rate", "HZ"));
        assert_eq!((all.text.as_str(), all.is_complete), ("--split-runs --rate HZ", false));
    }
}
