//! Limits of the sizes of files and functions, for readability.

use super::root;
use std::process::Command;

/// Source files with their text. `None` outside a git checkout.
pub fn sources(suffixes: &[&str]) -> Option<Vec<(String, String)>> {
    let listed = Command::new("git").arg("ls-files").args(suffixes).current_dir(root()).output();
    let Some(listed) = listed.ok().filter(|o| o.status.success()) else {
        eprintln!("SKIPPED: not a git checkout, so there is no list of source files");
        return None;
    };
    let listed = String::from_utf8_lossy(&listed.stdout).into_owned();
    let read = |file: &str| Some((file.to_owned(), std::fs::read_to_string(root().join(file)).ok()?));
    Some(listed.lines().filter_map(read).collect())
}

#[test]
fn the_median_source_file_is_under_150_lines() {
    // The models of the Python client are generated.
    let files = ["*.rs", "*.ts", "*.svelte", "*.py", ":!python/src/jointbench/models.py"];
    let Some(sources) = sources(&files) else { return };
    let mut lines: Vec<(usize, String)> =
        sources.into_iter().map(|(file, text)| (text.lines().count(), file)).collect();
    lines.sort();
    let median = lines[lines.len() / 2].0;
    assert!(median < 150, "the median source file has {median} lines");
    let long: Vec<_> = lines.iter().filter(|(count, _)| *count > 400).collect();
    assert!(long.is_empty(), "files over 400 lines, to be split: {long:?}");
}

/// Functions of formatted Rust with their numbers of lines: from `fn` to the brace in the same column.
fn functions(text: &str) -> Vec<(usize, String)> {
    let lines: Vec<&str> = text.lines().collect();
    let name = |line: &str| {
        let words = ["pub(crate) ", "pub(super) ", "pub ", "const ", "async ", "unsafe "];
        let head = words.iter().fold(line.trim_start(), |rest, word| rest.strip_prefix(word).unwrap_or(rest));
        Some(head.strip_prefix("fn ")?.split(['(', '<']).next()?.to_owned())
    };
    let measure = |(at, line): (usize, &&str)| {
        let (name, indent) = (name(line)?, &line[..line.len() - line.trim_start().len()]);
        let body = lines[at..].iter().position(|line| line.ends_with(['{', '}', ';']))? + at;
        let end = match lines[body].ends_with('{') {
            true => lines[body..].iter().position(|line| line.strip_prefix(indent) == Some("}"))? + body,
            false => body,
        };
        Some((end + 1 - at, name))
    };
    lines.iter().enumerate().filter_map(measure).collect()
}

#[test]
fn functions_are_short() {
    let Some(sources) = sources(&["*.rs"]) else { return };
    let of_file = |(file, text): &(String, String)| {
        functions(text).into_iter().map(|(lines, name)| (lines, format!("{name} in {file}"))).collect::<Vec<_>>()
    };
    let mut all: Vec<(usize, String)> = sources.iter().flat_map(of_file).collect();
    all.sort_by(|a, b| b.cmp(a));
    println!("the longest functions: {:#?}", &all[..10]);
    assert!(all.len() > 5_000, "{} functions were found", all.len());
    let long: Vec<_> = all.iter().filter(|(lines, _)| *lines > 60).collect();
    assert!(long.len() <= 10 && long.iter().all(|(lines, _)| *lines <= 80), "functions to be split: {long:#?}");
}

#[test]
fn functions_are_measured_to_their_closing_brace() {
    let text = "impl A {\n    pub fn one(\n        a: u8,\n    ) -> u8 {\n        if a > 1 {\n        }\n        a\n    }\n\n    fn two() {}\n}\n";
    assert_eq!(functions(text), [(7, "one".to_owned()), (1, "two".to_owned())]);
}
