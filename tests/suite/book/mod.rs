//! The book in `docs/`: its pages, its links, and its recipes.

#[cfg(unix)]
mod ci;
mod commands;
mod links;
mod rest;

use crate::house::root;
use std::collections::BTreeSet;
use std::path::PathBuf;

fn docs() -> PathBuf {
    root().join("docs")
}

/// A page of `docs/`.
fn page(name: &str) -> String {
    std::fs::read_to_string(docs().join(name)).unwrap_or_else(|fault| panic!("docs/{name}: {fault}"))
}

/// The names of all pages.
fn pages() -> BTreeSet<String> {
    let entries = std::fs::read_dir(docs()).expect("docs/").map_while(Result::ok);
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    names.filter(|name| name.ends_with(".md") && name != "SUMMARY.md").collect()
}

/// The blocks of code of a page, with their languages.
fn code_blocks(text: &str) -> Vec<(&str, String)> {
    let mut blocks = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some(language) = line.trim_start().strip_prefix("```") {
            let code = lines.by_ref().take_while(|line| line.trim() != "```");
            blocks.push((language, code.map(|line| format!("{line}\n")).collect()));
        }
    }
    blocks
}

#[test]
fn blocks_of_code_have_languages() {
    let blocks = code_blocks("a\n```sh\nb\nc\n```\n\n```\nd\n```\n");
    assert_eq!(blocks, [("sh", "b\nc\n".to_owned()), ("", "d\n".to_owned())]);
}
