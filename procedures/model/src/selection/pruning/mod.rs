//! Rules that remove an added effect from a model, one file for each rule.

pub(crate) mod infeasible;
pub(crate) mod insignificant;
pub(crate) mod mutually_cancelling;
pub(crate) mod partial_explanation;
pub(crate) mod random_walk;
pub(crate) mod redundant;
pub(crate) mod spurious;
pub(crate) mod swapped;
pub(crate) mod unidentified;

#[cfg(test)]
mod tests {
    use crate::report::diagnosis::RemovalReason;

    #[test]
    fn the_docs_list_the_rules_in_the_order_in_which_they_run() {
        let docs = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/diagnosis.md")).unwrap();
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/selection/pruning");
        let mut files: Vec<String> = (std::fs::read_dir(folder).unwrap())
            .filter_map(|file| Some(file.unwrap().file_name().to_str()?.strip_suffix(".rs")?.to_owned()))
            .filter(|name| name != "mod")
            .collect();
        files.sort();
        let name = |reason: &RemovalReason| serde_json::to_value(reason).unwrap().as_str().unwrap().to_owned();
        let rules: Vec<String> = RemovalReason::ALL.iter().map(name).collect();
        let mut sorted = rules.clone();
        sorted.sort();
        assert_eq!(sorted, files, "a rule is a file of selection/pruning");
        let row = |rule: &String| docs.find(&format!("\n| {} |", rule.replace('_', " ")));
        let rows: Vec<usize> = rules.iter().map(|rule| row(rule).unwrap_or_else(|| panic!("{rule}"))).collect();
        assert!(rows.is_sorted(), "the rows of docs/diagnosis.md follow another order: {rows:?}");
    }
}
