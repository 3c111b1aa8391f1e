//! Style sheet, with the run in the head of each printed page.

use std::fmt::Write;

/// A customer may separate the pages, so that each of them names the run and the origin of its data.
pub fn sheet(title: &str, origin: &str) -> String {
    let (title, origin) = (quoted(title), quoted(origin));
    format!(
        "{}@page {{ @top-left {{ content: {title}; }} @top-right {{ content: {origin}; }} \
         @bottom-right {{ content: \"Page \" counter(page) \" of \" counter(pages); }} }}\n",
        include_str!("style.css")
    )
}

/// A string of CSS. Every other character than letters and digits is written as its number, so that no name ends the
/// string or the style sheet.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        // Writing to a string cannot fail.
        let _ = match letter {
            'a'..='z' | 'A'..='Z' | '0'..='9' | ' ' => write!(quoted, "{letter}"),
            '\0' => Ok(()),
            // The space ends the number.
            _ => write!(quoted, "\\{:x} ", letter as u32),
        };
    }
    quoted + "\""
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_does_not_end_the_style_sheet() {
        let text = sheet("Run 7: friction on \"</style><script>\"\\", "IMPORTED");
        assert!(!text.contains("</style>") && !text.contains("<script"), "{text}");
        assert!(text.contains(r#"content: "Run 7\3a  friction on \22 \3c \2f style"#), "{text}");
    }
}
