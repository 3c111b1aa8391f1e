//! Names and sentences of users: limited in length, without characters that change the display of other text.

use super::{Answer, ImportRequest, LabError};
use crate::view::EffectDefinition;

pub const LONGEST_TOKEN_NAME: usize = 40;
pub const LONGEST_TAG: usize = 40;
pub const LONGEST_NOTE: usize = 4000;
/// Of a unit under test, and the name of an operator.
pub const LONGEST_UNIT_TEXT: usize = 80;
/// Of effects, their parameters and units.
const LONGEST_ID: usize = 64;
/// Of files and imported runs.
pub const LONGEST_NAME: usize = 200;
/// Reason of a release, title of an effect.
pub const LONGEST_SENTENCE: usize = 400;

/// One trimmed line of 1 to `longest` characters, all of them visible.
pub fn checked<'t>(what: &str, text: &'t str, longest: usize) -> Answer<&'t str> {
    let line = text.trim();
    if line.is_empty() || line.chars().count() > longest || line.chars().any(is_unseen) {
        return Err(LabError::Invalid(format!("{what}: write 1 to {longest} characters in one line")));
    }
    Ok(line)
}

/// Like [`checked`], but allows several lines.
pub fn checked_text<'t>(what: &str, text: &'t str, longest: usize) -> Answer<&'t str> {
    let text = text.trim();
    let odd = |c: char| is_unseen(c) && !matches!(c, '\n' | '\r' | '\t');
    if text.is_empty() || text.chars().count() > longest || text.chars().any(odd) {
        return Err(LabError::Invalid(format!("{what}: write 1 to {longest} characters")));
    }
    Ok(text)
}

/// Checks all texts of a user's effect. The parser of formulas checks the id.
pub fn check_effect(definition: &EffectDefinition) -> Answer<()> {
    let short = [("id", &definition.id)].into_iter();
    let short = short.chain(definition.parameters.iter().flat_map(|p| [("parameter", &p.name), ("unit", &p.unit)]));
    let long = [("title", &definition.title), ("sentence", &definition.sentence)];
    let bounds = short.map(|one| (one, LONGEST_ID)).chain(long.map(|one| (one, LONGEST_SENTENCE)));
    for ((what, text), longest) in bounds.filter(|((_, text), _)| !text.trim().is_empty()) {
        checked(what, text, longest)?;
    }
    Ok(())
}

impl ImportRequest {
    /// Makes the names displayable: checks the name of a user and cleans the name of a file.
    pub(super) fn with_names(mut self) -> Answer<Self> {
        if let Some(name) = &self.name {
            self.name = Some(checked("name", name, LONGEST_NAME)?.to_owned());
        }
        self.file_name = cleaned(&self.file_name, LONGEST_NAME);
        Ok(self)
    }
}

/// A name from elsewhere, such as a file name: removes invalid characters and truncates it.
pub fn cleaned(name: &str, longest: usize) -> String {
    name.chars().filter(|c| !is_unseen(*c)).take(longest).collect()
}

/// A character that moves, hides or reverses the text around it: control characters and marks of writing direction.
fn is_unseen(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_one_visible_line() {
        assert_eq!(checked("name", "  wall screen ", 40).unwrap(), "wall screen");
        for odd in ["", " ", "a\nb", "a\u{1b}[31m", "a\0", "gpj.\u{202e}csv", &"x".repeat(41)] {
            let error = checked("name", odd, 40).unwrap_err().to_string();
            assert_eq!(error, "name: write 1 to 40 characters in one line", "{odd:?}");
        }
        assert_eq!(checked_text("text", "two\nlines ", 40).unwrap(), "two\nlines");
        assert!(checked_text("text", "a\u{7}b", 40).is_err());
        assert_eq!(cleaned("a\r\nb\u{202e}.csv", 4), "ab.c");
    }
}
