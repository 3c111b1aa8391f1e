//! The list of pages and the links.

use super::{docs, page, pages};
use crate::house::root;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Documents outside of the book.
const OTHERS: [&str; 4] = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "python/README.md"];

/// The text without code, in which brackets are no links.
fn prose(text: &str) -> String {
    let mut is_code = false;
    let outside = text.lines().filter(|line| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    });
    let text = outside.collect::<Vec<_>>().join("\n");
    text.split('`').enumerate().map(|(at, part)| if at % 2 == 0 { part } else { "code" }).collect()
}

/// Targets of the links and pictures of a text.
fn targets(text: &str) -> Vec<String> {
    let text = prose(text);
    let ends = text.match_indices("](").map(|(at, mark)| &text[at + mark.len()..]);
    ends.filter_map(|rest| rest.split_once(')')).map(|(target, _)| target.to_owned()).collect()
}

/// Names of the headings as parts of addresses, as GitHub and mdBook form them.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut is_code = false;
    let mut seen = BTreeMap::<String, usize>::new();
    let headings = text.lines().filter(|line| {
        is_code ^= line.trim_start().starts_with("```");
        !is_code && line.starts_with('#')
    });
    let name = |heading: &str| {
        let words = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = words.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect::<String>()
    };
    let numbered = headings.map(name).map(|name| {
        let count = seen.entry(name.clone()).and_modify(|count| *count += 1).or_default();
        if *count == 0 { name } else { format!("{name}-{count}") }
    });
    numbered.collect()
}

/// Why a link of the document leads nowhere.
fn broken(document: &Path, text: &str, target: &str) -> Option<String> {
    if target.contains("://") || target.starts_with("mailto:") {
        return None;
    }
    let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
    let path = if file.is_empty() { document.to_owned() } else { document.parent()?.join(file) };
    let missing = |what: &str| Some(format!("{}: {target}: {what}", document.display()));
    if !path.exists() {
        return missing("there is no such file");
    }
    let is_page = document.starts_with(docs());
    if is_page && !path.canonicalize().is_ok_and(|path| docs().canonicalize().is_ok_and(|docs| path.starts_with(docs)))
    {
        return missing("a page links inside docs/, so that the book is complete; write the path as code");
    }
    if anchor.is_empty() {
        return None;
    }
    let found = if file.is_empty() { text.to_owned() } else { std::fs::read_to_string(&path).unwrap_or_default() };
    if anchors(&found).contains(anchor) { None } else { missing("there is no such heading") }
}

#[test]
fn the_summary_lists_every_page_once() {
    let settings = page("book.toml");
    assert!(settings.contains("src = \".\""), "{settings}");
    let mut listed = targets(&page("SUMMARY.md"));
    listed.sort();
    assert_eq!(listed, pages().into_iter().collect::<Vec<_>>(), "docs/SUMMARY.md (left) and the pages of docs/");
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let of_book = pages().into_iter().map(|name| docs().join(name)).chain([docs().join("SUMMARY.md")]);
    let documents: Vec<PathBuf> = of_book.chain(OTHERS.map(|name| root().join(name))).collect();
    let mut count = 0;
    let mut wrong = Vec::new();
    for document in documents {
        let text = std::fs::read_to_string(&document).unwrap_or_else(|fault| panic!("{}: {fault}", document.display()));
        let all = targets(&text);
        count += all.len();
        wrong.extend(all.iter().filter_map(|target| broken(&document, &text, target)));
    }
    assert!(count > 80, "only {count} links were found");
    assert!(wrong.is_empty(), "links that lead nowhere:\n{}", wrong.join("\n"));
}

#[test]
fn a_link_is_judged_by_its_file_and_its_heading() {
    let text = "# One, *two*\n```\n[no](link.md)\n# no\n```\n`[no](x)` [a](#one-two) ![b](c.gif)\n# One two\n";
    assert_eq!(targets(text), ["#one-two", "c.gif"]);
    assert_eq!(anchors(text).into_iter().collect::<Vec<_>>(), ["one-two", "one-two-1"]);
    let document = docs().join("SUMMARY.md");
    let why = |target: &str| broken(&document, text, target).unwrap_or_default();
    assert_eq!((why("#one-two-1"), why("https://example.org")), (String::new(), String::new()));
    assert!(why("#one-two-2").ends_with("there is no such heading"));
    assert!(why("nowhere.md").ends_with("there is no such file"));
    assert!(why("../README.md").contains("so that the book is complete"));
}
