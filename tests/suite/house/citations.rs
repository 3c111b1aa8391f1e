//! Every cited work has an entry in `docs/references.md`.

use super::root;
use super::sizes::sources;
use std::collections::BTreeSet;

/// The words of a text with their punctuation.
fn words(text: &str) -> Vec<&str> {
    text.split_whitespace().collect()
}

/// A year of publication, without the punctuation that follows it.
fn year(word: &str) -> Option<&str> {
    let digits = word.trim_start_matches('(').trim_end_matches(|c: char| !c.is_ascii_digit() && c != '-');
    let of_print = |year: u32| (1850..2100).contains(&year);
    (digits.len() == 4 && digits.parse().is_ok_and(of_print)).then_some(digits)
}

/// The last author and the year of each citation `(first and last YEAR)` in a text.
fn cited(text: &str) -> Vec<(String, String)> {
    let words = words(text);
    let mut cited = Vec::new();
    for (at, word) in words.iter().enumerate() {
        let Some(year) = year(word) else { continue };
        let is_author = |other: &&&str| !["et", "al."].contains(*other);
        let Some(author) = words[..at].iter().rev().find(is_author) else { continue };
        let author = author.trim_matches(|c: char| !c.is_alphanumeric());
        let is_name = author.chars().next().is_some_and(char::is_uppercase) && author.chars().count() > 2;
        if is_name && !author.chars().all(char::is_uppercase) {
            cited.push((author.to_owned(), year.to_owned()));
        }
    }
    cited
}

/// Authors and year of each reference.
fn references() -> BTreeSet<(String, String)> {
    let text = std::fs::read_to_string(root().join("docs/references.md")).expect("docs/references.md");
    let mut known = BTreeSet::new();
    for head in text.lines().filter_map(|line| line.strip_prefix("* ")?.split_once(':').map(|(head, _)| head)) {
        let Some((authors, year)) = head.rsplit_once(' ') else { continue };
        for author in authors.split(", ").map(|author| author.trim_end_matches(" et al.")) {
            let surname = author.rsplit(' ').next().unwrap_or(author);
            known.insert((surname.to_owned(), year.to_owned()));
        }
    }
    known
}

/// The comments of a source file, or a document without its blocks of code.
fn prose(path: &str, text: &str) -> String {
    if path.ends_with(".md") {
        return text.split("\n```").step_by(2).collect();
    }
    let comment = |line: &str| {
        let line = line.trim_start();
        let of = ["///", "//!", "//", "/**", "* "].into_iter().find_map(|mark| line.strip_prefix(mark))?;
        Some(of.to_owned())
    };
    text.lines().filter_map(comment).collect::<Vec<_>>().join("\n")
}

#[test]
fn every_citation_has_a_reference() {
    let Some(sources) = sources(&["*.rs", "*.ts", "*.svelte", "*.py", "*.md", ":!docs/references.md"]) else { return };
    let known = references();
    assert!(known.contains(&("Ljung".to_owned(), "1999".to_owned())), "the list of references is read");
    let (mut missing, mut count) = (Vec::new(), 0);
    for (path, text) in &sources {
        for citation in cited(&prose(path, text)) {
            count += 1;
            if !known.contains(&citation) {
                missing.push(format!("{path}: {} {}", citation.0, citation.1));
            }
        }
    }
    assert!(count > 40, "only {count} citations were found");
    assert_eq!(missing, Vec::<String>::new(), "not in docs/references.md");
}

#[test]
fn a_citation_is_the_last_author_and_the_year() {
    let found =
        |text: &str| cited(text).into_iter().map(|(author, year)| format!("{author} {year}")).collect::<Vec<_>>();
    assert_eq!(
        found("the jackknife (MacKinnon, Nielsen, Webb 2023), as in Bittencourt et al. 2010."),
        ["Webb 2023", "Bittencourt 2010"]
    );
    assert_eq!(found("at 2000 rad/s; see ISO 1999, of 2026-11-28, table 1234"), Vec::<String>::new());
}
