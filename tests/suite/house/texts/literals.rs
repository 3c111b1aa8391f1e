//! The strings of Rust sources, without those of tests, comments and derive attributes.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::path::{Path, PathBuf};

/// Strings with more than one word (others are names), with their file.
pub fn under(root: &Path, folder: &Path) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for file in sources(&root.join(folder)) {
        let place = file.strip_prefix(root).unwrap_or(&file).display().to_string();
        let text = std::fs::read_to_string(&file).expect("a source");
        let tokens: TokenStream = text.parse().unwrap_or_else(|fault| panic!("{place}: {fault}"));
        let mut strings = Vec::new();
        collect(tokens, &mut strings);
        found.extend(strings.into_iter().filter(|text| text.contains(' ')).map(|text| (place.clone(), text)));
    }
    found
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    if folder.is_file() {
        return vec![folder.to_owned()];
    }
    let entries = std::fs::read_dir(folder).unwrap_or_else(|fault| panic!("{}: {fault}", folder.display()));
    let mut files = Vec::new();
    for path in entries.map(|entry| entry.expect("an entry").path()) {
        let name = path.file_stem().and_then(|name| name.to_str()).unwrap_or_default();
        if path.is_dir() && name != "tests" {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|ending| ending == "rs") && name != "tests" {
            files.push(path);
        }
    }
    files.sort();
    files
}

fn collect(tokens: TokenStream, strings: &mut Vec<String>) {
    let mut tokens = tokens.into_iter().peekable();
    // Tokens between `#[cfg(test)]` and its body.
    let mut is_test = false;
    while let Some(token) = tokens.next() {
        match token {
            TokenTree::Punct(mark) if mark.as_char() == '#' => {
                if let Some(TokenTree::Punct(_)) = tokens.peek() {
                    tokens.next();
                }
                if let Some(TokenTree::Group(attribute)) = tokens.next_if(|next| matches!(next, TokenTree::Group(_))) {
                    let inside = attribute.stream().to_string();
                    is_test |= inside.starts_with("cfg (test)") || inside.starts_with("cfg(test)") || inside == "test";
                    // `#[error("…")]` is a message; a doc comment is not.
                    if inside.starts_with("error") {
                        collect(attribute.stream(), strings);
                    }
                }
            }
            TokenTree::Punct(mark) if mark.as_char() == ';' => is_test = false,
            TokenTree::Group(group) if is_test && group.delimiter() == Delimiter::Brace => is_test = false,
            TokenTree::Group(group) if !is_test => collect(group.stream(), strings),
            TokenTree::Literal(literal) if !is_test => strings.extend(string(&literal.to_string())),
            _ => {}
        }
    }
}

/// The text of a string literal, with backslash line breaks removed.
fn string(literal: &str) -> Option<String> {
    let body = literal.trim_start_matches(['b', 'r', '#']).strip_prefix('"')?;
    let body = body.trim_end_matches('#').strip_suffix('"')?;
    let mut parts = body.split("\\\n");
    let first = parts.next()?.to_owned();
    Some(parts.fold(first, |text, part| text + part.trim_start()))
}

#[test]
fn strings_are_read_as_the_compiler_reads_them() {
    let mut strings = Vec::new();
    let text = r##"
        /// a comment that is none
        #[derive(Debug)]
        #[error("a message {x}")]
        fn f() { g("one \
            text", r#"another text"#, 'c', 7) }
        #[cfg(test)]
        mod tests { const NOT: &str = "of a test"; }
    "##;
    collect(text.parse().unwrap(), &mut strings);
    assert_eq!(strings, ["a message {x}", "one text", "another text"]);
}
