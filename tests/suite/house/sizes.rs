//! Limits of file sizes, for readability.

use super::root;
use std::process::Command;

#[test]
fn the_median_source_file_is_under_150_lines() {
    let listed = Command::new("git").args(["ls-files", "*.rs", "*.ts", "*.svelte"]).current_dir(root()).output();
    let Some(listed) = listed.ok().filter(|o| o.status.success()) else {
        eprintln!("SKIPPED: not a git checkout, so there is no list of source files");
        return;
    };
    let mut lines: Vec<(usize, String)> = String::from_utf8_lossy(&listed.stdout)
        .lines()
        .filter_map(|file| Some((std::fs::read_to_string(root().join(file)).ok()?.lines().count(), file.to_owned())))
        .collect();
    lines.sort();
    let median = lines[lines.len() / 2].0;
    assert!(median < 150, "the median source file has {median} lines");
    let long: Vec<_> = lines.iter().filter(|(count, _)| *count > 400).collect();
    assert!(long.is_empty(), "files over 400 lines, to be split: {long:?}");
}
