//! The texts of the documents: headings, paragraphs, list items and table rows, without blocks of code.

use std::path::{Path, PathBuf};

/// A heading, a paragraph, a list item or a table row.
#[derive(Debug, PartialEq)]
pub struct Block {
    pub is_table_row: bool,
    /// Number of its first line.
    pub line: usize,
    /// On one line, without bold marks and without targets of links.
    pub text: String,
}

/// The blocks of all documents, each with its file.
pub fn under(root: &Path) -> Vec<(String, Block)> {
    let mut found = Vec::new();
    for path in files(root) {
        let file = path.strip_prefix(root).unwrap_or(&path).display().to_string();
        let document = std::fs::read_to_string(&path).unwrap_or_else(|fault| panic!("{file}: {fault}"));
        // A list item of the references quotes the title of a work, which has words of its own.
        let is_title = |block: &Block| file == "docs/references.md" && is_item(&block.text);
        let texts = blocks(&document).into_iter().filter(|block| !is_title(block));
        found.extend(texts.map(|block| (file.clone(), block)));
    }
    found
}

/// The documents for users and developers.
fn files(root: &Path) -> Vec<PathBuf> {
    let top = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| root.join(name));
    let mut files = Vec::from(top);
    // mdBook writes its output to docs/book.
    collect(&root.join("docs"), &root.join("docs/book"), &mut files);
    files
}

fn collect(folder: &Path, output: &Path, files: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|fault| panic!("{}: {fault}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() && path != output {
            collect(&path, output, files);
        } else if path.extension().is_some_and(|ending| ending == "md") {
            files.push(path);
        }
    }
}

/// The blocks of a document in Markdown.
fn blocks(document: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut is_code = false;
    // The next line continues the last block.
    let mut is_open = false;
    for (number, line) in (1..).zip(document.lines()) {
        let text = line.trim();
        let is_fence = text.starts_with("```");
        is_code ^= is_fence;
        let is_indented_code = !is_open && line.starts_with("    ");
        if is_code || is_fence || is_indented_code || text.is_empty() {
            is_open = false;
            continue;
        }
        let is_table_row = text.starts_with('|');
        let is_whole = is_table_row || text.starts_with('#');
        if is_open && !is_whole && !is_item(text) {
            if let Some(last) = blocks.last_mut() {
                last.text.push(' ');
                last.text.push_str(&plain(text));
            }
        } else {
            blocks.push(Block { is_table_row, line: number, text: plain(text) });
        }
        is_open = !is_whole;
    }
    blocks
}

/// The line begins a list item.
fn is_item(line: &str) -> bool {
    let unnumbered = line.trim_start_matches(|c: char| c.is_ascii_digit());
    let is_numbered = unnumbered.len() < line.len() && unnumbered.starts_with(". ");
    is_numbered || line.starts_with("* ") || line.starts_with("- ")
}

/// A line without bold marks, which hide the end of a sentence, and without targets of links.
fn plain(line: &str) -> String {
    let mut parts = line.split("](");
    let first = parts.next().unwrap_or_default().to_owned();
    let text = parts.fold(first, |text, part| text + "]" + part.split_once(')').map_or(part, |(_, after)| after));
    text.replace("**", "")
}

#[test]
fn documents_are_read_as_paragraphs_items_and_rows_without_code() {
    let document = "# Title\nOne **word**\nand [a link](docs/archive.md).\n\n    indented code\n\n```sh\ncode\n```\n\
                    1. first\n   continued\n* second\n| a | b |\n| c | d |\nafter\n";
    let found = blocks(document).into_iter().map(|block| (block.is_table_row, block.line, block.text));
    let expected = [
        (false, 1, "# Title"),
        (false, 2, "One word and [a link]."),
        (false, 10, "1. first continued"),
        (false, 12, "* second"),
        (true, 13, "| a | b |"),
        (true, 14, "| c | d |"),
        (false, 15, "after"),
    ];
    let expected = expected.map(|(is_table_row, line, text)| (is_table_row, line, text.to_owned()));
    assert_eq!(found.collect::<Vec<_>>(), expected);
}
