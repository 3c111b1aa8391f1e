//! Names and sentences that people give: bounded in length, and free of characters that change how the rest is shown.

use super::{Answer, ImportRequest, LabError};
use crate::view::EffectDefinition;

pub const LONGEST_TOKEN_NAME: usize = 40;
pub const LONGEST_TAG: usize = 40;
pub const LONGEST_NOTE: usize = 4000;
/// Of an effect, of its parameters and their units.
const LONGEST_ID: usize = 64;
/// Of a file, of a run that comes in.
pub const LONGEST_NAME: usize = 200;
/// Why a bench was released, what an effect is called.
pub const LONGEST_SENTENCE: usize = 400;

/// One line without its outer spaces: 1 to `longest` characters, none of which is invisible.
pub fn checked<'t>(what: &str, text: &'t str, longest: usize) -> Answer<&'t str> {
    let line = text.trim();
    if line.is_empty() || line.chars().count() > longest || line.chars().any(is_unseen) {
        return Err(LabError::Invalid(format!("{what}: write 1 to {longest} characters in one line")));
    }
    Ok(line)
}

/// As [`checked`], with more than one line.
pub fn checked_text<'t>(what: &str, text: &'t str, longest: usize) -> Answer<&'t str> {
    let text = text.trim();
    let odd = |c: char| is_unseen(c) && !matches!(c, '\n' | '\r' | '\t');
    if text.is_empty() || text.chars().count() > longest || text.chars().any(odd) {
        return Err(LabError::Invalid(format!("{what}: write 1 to {longest} characters")));
    }
    Ok(text)
}

/// Every text of a user's effect. What an id may consist of, the formulas say.
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
    /// With names that can be shown: the one that a person gave is checked, the one that a file has is cleaned.
    pub(super) fn with_names(mut self) -> Answer<Self> {
        if let Some(name) = &self.name {
            self.name = Some(checked("name", name, LONGEST_NAME)?.to_owned());
        }
        self.file_name = cleaned(&self.file_name, LONGEST_NAME);
        Ok(self)
    }
}

/// A name that comes from elsewhere, such as that of a file: what may not stand in it is left out, and it is cut.
pub fn cleaned(name: &str, longest: usize) -> String {
    name.chars().filter(|c| !is_unseen(*c)).take(longest).collect()
}

/// A character that moves, hides or turns what stands around it: controls, and the marks of writing direction.
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
