//! The licence of every included library permits distribution with the product.

use super::packages;

/// SPDX ids that the product may contain. MPL-2.0 is file-wise copyleft: used unchanged (serialport).
/// CDLA-Permissive-2.0 is for data: the list of public certificate authorities (webpki-roots).
const ALLOWED: [&str; 15] = [
    "MIT",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-1-Clause",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "ISC",
    "Zlib",
    "0BSD",
    "Unlicense",
    "CC0-1.0",
    "MPL-2.0",
    "Unicode-3.0",
    "BSL-1.0",
    "CDLA-Permissive-2.0",
];

/// Whether an SPDX expression is satisfied: one side of every OR, both sides of every AND.
fn is_met(expression: &str) -> bool {
    let expression = expression.replace('/', " OR ");
    let expression = expression.trim();
    if let Some((left, right)) = split_outside(expression, " OR ") {
        return is_met(left) || is_met(right);
    }
    if let Some((left, right)) = split_outside(expression, " AND ") {
        return is_met(left) && is_met(right);
    }
    match expression.strip_prefix('(').and_then(|e| e.strip_suffix(')')) {
        Some(inner) => is_met(inner),
        None => ALLOWED.contains(&expression),
    }
}

/// Splits at the first separator outside of brackets.
fn split_outside<'a>(text: &'a str, separator: &str) -> Option<(&'a str, &'a str)> {
    let mut depth = 0;
    for (i, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ if depth == 0 && text[i..].starts_with(separator) => {
                return Some((&text[..i], &text[i + separator.len()..]));
            }
            _ => {}
        }
    }
    None
}

#[test]
fn every_library_has_an_allowed_licence() {
    let refused: Vec<String> = packages()
        .filter(|(_, p)| !p["license"].as_str().is_some_and(is_met))
        .map(|(_, p)| format!("{} {}: {}", p["name"], p["version"], p["license"]))
        .collect();
    assert!(refused.is_empty(), "licences not on the allow-list:\n{}", refused.join("\n"));
}

#[test]
fn expressions_are_read_as_spdx_means_them() {
    assert!(is_met("MIT OR GPL-3.0"));
    assert!(!is_met("MIT AND GPL-3.0"));
    assert!(is_met("(MIT OR Apache-2.0) AND Unicode-3.0"));
    assert!(is_met("MIT/Apache-2.0"));
    assert!(!is_met("LGPL-2.1"));
}
