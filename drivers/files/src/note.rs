//! Notes for the user about skipped or assumed parts of an import.

use crate::ProposedOption;
use serde::{Deserialize, Serialize};

/// One skipped, assumed or noticed item, and the option that changes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Note {
    /// A clause without a full stop.
    #[serde(rename = "said")]
    pub message: String,
    /// Such as `--leave remark`.
    pub option: Option<ProposedOption>,
}

impl Note {
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), option: None }
    }

    pub fn with(message: impl Into<String>, option: ProposedOption) -> Self {
        Self { message: message.into(), option: Some(option) }
    }
}

impl std::fmt::Display for Note {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.option {
            Some(option) => write!(f, "{} ({option})", self.message),
            None => f.write_str(&self.message),
        }
    }
}

/// All notes in one paragraph; empty without notes.
pub fn paragraph(notes: &[Note]) -> String {
    let messages: Vec<String> = notes.iter().map(Note::to_string).collect();
    if messages.is_empty() { String::new() } else { format!("{}.", messages.join("; ")) }
}

/// 34442 → 34,442.
pub fn counted(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// `1 row`, `2 rows`.
pub fn plural(number: usize, one: &str) -> String {
    format!("{} {one}{}", counted(number), if number == 1 { "" } else { "s" })
}

/// A word of the command line, quoted if a shell would split or change it.
pub fn shell(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_-=./,:+%@".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_are_one_paragraph() {
        let notes = [
            Note::new("one line was skipped"),
            Note::with("remark was left out", ProposedOption::new("map", "x=remark")),
        ];
        assert_eq!(paragraph(&notes), "one line was skipped; remark was left out (--map x=remark).");
        assert_eq!(paragraph(&[]), "");
        assert_eq!(
            (counted(999), counted(34_442), counted(1_000_000)),
            ("999".into(), "34,442".into(), "1,000,000".into())
        );
        assert_eq!((plural(1, "row"), plural(1200, "row")), ("1 row".into(), "1,200 rows".into()));
        assert_eq!((shell("time_s=t"), shell("t=Time [ms]")), ("time_s=t".into(), "'t=Time [ms]'".into()));
    }
}
