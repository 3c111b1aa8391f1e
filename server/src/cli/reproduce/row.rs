//! The rows of the source documents, as written in `rows.txt`.

use super::evidence::Evidence;

/// One system, instrument, procedure, table, model or effect of a document.
pub struct Row {
    /// Document and chapter.
    pub section: &'static str,
    pub kind: &'static str,
    pub item: &'static str,
    /// Figure of the document that no run measures as such; empty if there is none.
    pub figure: &'static str,
    /// The evidence as written.
    shown_by: &'static str,
    pub evidence: Vec<Evidence>,
    /// What the product lacks; empty if it lacks nothing.
    pub missing: &'static str,
}

const TEXT: &str = include_str!("rows.txt");
/// Between two pieces of evidence.
const SEPARATOR: &str = "; ";
const KINDS: [&str; 6] = ["system", "instrument", "procedure", "table", "model", "effect"];

/// Every row, or the line that is none.
pub fn rows() -> Result<Vec<Row>, String> {
    let mut section = "";
    let mut rows = Vec::new();
    for line in TEXT.lines().filter(|line| !line.is_empty()) {
        match line.strip_prefix('#') {
            Some(comment) => section = comment.strip_prefix("# ").unwrap_or(section),
            None => rows.push(Row::parse(section, line).ok_or_else(|| format!("rows.txt: {line}"))?),
        }
    }
    Ok(rows)
}

impl Row {
    #[cfg(test)]
    pub fn new(evidence: Vec<Evidence>, missing: &'static str) -> Self {
        let (section, kind, item, figure, shown_by) = ("", "effect", "Friction", "", "");
        Self { section, kind, item, figure, shown_by, evidence, missing }
    }

    /// What shows the row, one text for each.
    pub fn evidence_texts(&self) -> impl Iterator<Item = &'static str> {
        self.shown_by.split(SEPARATOR).filter(|one| !one.is_empty())
    }

    fn parse(section: &'static str, line: &'static str) -> Option<Self> {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [kind, item, figure, shown_by, missing] = cells[..] else { return None };
        let evidence: Vec<Evidence> =
            shown_by.split(SEPARATOR).filter(|one| !one.is_empty()).map(Evidence::parse).collect::<Option<_>>()?;
        let is_shown = !evidence.is_empty() || !missing.is_empty();
        (is_shown && KINDS.contains(&kind)).then_some(Self { section, kind, item, figure, shown_by, evidence, missing })
    }
}

#[cfg(test)]
mod tests {
    use super::super::benches;
    use super::*;
    use jointbench_model::effects;
    use jointbench_procedure::procedure;
    use std::fs;
    use std::path::Path;

    #[test]
    fn every_row_names_what_exists() {
        let rows = rows().unwrap();
        assert_eq!(rows.len(), 116);
        for row in &rows {
            for evidence in &row.evidence {
                assert_exists(evidence, row.item);
            }
        }
        let mut items: Vec<_> = rows.iter().map(|row| (row.section, row.item)).collect();
        items.sort_unstable();
        items.dedup();
        assert_eq!(items.len(), rows.len(), "an item of a section is there twice");
    }

    fn assert_exists(evidence: &Evidence, item: &str) {
        match evidence {
            Evidence::Figures { bench, names } => {
                assert!(benches::named(bench, 1).is_some() && !names.is_empty(), "{item}: figures of {bench}");
            }
            Evidence::Run { run, .. } => {
                assert!(benches::named(&run.bench, 1).is_some(), "{item}: bench {}", run.bench);
                let procedure = procedure(&run.procedure).unwrap_or_else(|| panic!("{item}: {}", run.procedure));
                let is_known = |name: &String| procedure.schema().iter().any(|parameter| parameter.name == name);
                assert!(run.parameters.keys().all(is_known), "{item}: parameters of {}", run.procedure);
            }
            Evidence::Driver { bench, .. } => assert!(benches::named(bench, 1).is_some(), "{item}: bench {bench}"),
            Evidence::Effect { kind, id } => {
                assert!(effects(*kind).iter().any(|effect| effect.info().id == id.as_str()), "{item}: effect {id}");
            }
            Evidence::Test { file, name } => {
                let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
                let text = fs::read_to_string(&path).unwrap_or_else(|fault| panic!("{item}: {file}: {fault}"));
                assert!(has_test(&text, name), "{item}: {file} has no test {name}");
            }
        }
    }

    /// Whether a source has a test function with this name.
    fn has_test(source: &str, name: &str) -> bool {
        let head = source.split(&format!("fn {name}(")).next().filter(|head| head.len() < source.len());
        let attributes = head.and_then(|head| Some(&head[head.rfind("test]\n")?..]));
        attributes.is_some_and(|lines| !lines.contains("fn "))
    }

    #[test]
    fn a_function_is_a_test_only_with_its_attribute() {
        let source = "#[test]\n#[ignore]\nfn a() {}\nfn b() {}\n#[tokio::test]\nasync fn c() {}\n";
        assert_eq!(["a", "b", "c", "d"].map(|name| has_test(source, name)), [true, false, true, false]);
        let ordinary = "#[test]\nfn a() {}\nfn helper() {}\n";
        assert!(!has_test(ordinary, "helper") && has_test(ordinary, "a"));
    }

    #[test]
    fn a_line_without_evidence_or_reason_is_no_row() {
        assert!(Row::parse("", "effect | Friction | | effect friction: coulomb |").is_some());
        for line in ["effect | Friction | | |", "idea | Friction | | | none", "effect | Friction | |"] {
            assert!(Row::parse("", line).is_none(), "{line}");
        }
    }
}
