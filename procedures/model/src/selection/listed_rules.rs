//! The rules of a folder, its files, and docs/diagnosis.md list the same rules in the same order.

use std::fs;

/// Compares the names of rules with the files of a folder of `selection`, and with the rows of the documents.
pub fn check(folder: &str, names: &[&str]) {
    let manifest = env!("CARGO_MANIFEST_DIR");
    let docs = fs::read_to_string(format!("{manifest}/../../docs/diagnosis.md")).unwrap().replace('-', " ");
    let mut files: Vec<String> = (fs::read_dir(format!("{manifest}/src/selection/{folder}")).unwrap())
        .filter_map(|file| Some(file.unwrap().file_name().to_str()?.strip_suffix(".rs")?.replace('_', " ")))
        .filter(|name| name != "mod")
        .collect();
    files.sort();
    let mut sorted = names.to_vec();
    sorted.sort_unstable();
    assert_eq!(sorted, files, "a rule is a file of selection/{folder}");
    let rows: Vec<&str> = docs.lines().filter_map(|line| line.strip_prefix("| ")?.split(" |").next()).collect();
    let is_listed = rows.windows(names.len()).any(|rows| rows == names);
    assert!(is_listed, "docs/diagnosis.md has no table of the rules of selection/{folder} in this order: {names:?}");
}
