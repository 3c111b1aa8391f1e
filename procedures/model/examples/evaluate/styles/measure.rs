//! Tables of the second generator, by kind and by style.

use super::answer::Answer;
use super::score::{Score, score};
use super::{Case, MAKERS, case, write};
use crate::common;
use crate::options::Asked;
use crate::score::Count;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

/// Simulated cases: scored, or written as folders.
pub fn measure(asked: &Asked) -> Result<(), Box<dyn Error>> {
    let numbers = || (asked.first..).take(asked.count as usize);
    let kinds = MAKERS.iter().map(|(kind, _)| *kind);
    let cases = kinds.flat_map(|kind| numbers().filter_map(move |seed| case(kind, seed)));
    let cases = cases.filter(|case| asked.takes(&case.answer.kind, &case.name));
    if let Some(into) = &asked.write {
        return cases.into_iter().try_for_each(|case| write::folder(&case, into));
    }
    report("Second generator", cases.map(Ok), asked.quiet)
}

/// Cases of a folder, in the format of `write`.
pub fn evaluate(folder: &Path, asked: &Asked) -> Result<(), Box<dyn Error>> {
    let mut folders: Vec<_> = std::fs::read_dir(folder)?.filter_map(|e| Some(e.ok()?.path())).collect();
    folders.retain(|f| f.join("answer.json").is_file());
    folders.sort();
    let read = |folder: &std::path::PathBuf| -> Result<Case, Box<dyn Error>> {
        let answer: Answer = serde_json::from_str(&std::fs::read_to_string(folder.join("answer.json"))?)?;
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Case { name, run: common::read(folder), answer })
    };
    let is_asked = |case: &Result<Case, _>| case.as_ref().map_or(true, |c| asked.takes(&c.answer.kind, &c.name));
    let cases = folders.iter().map(read).filter(is_asked);
    report("Cases of a folder", cases, asked.quiet)
}

/// Counts of one row of a table.
#[derive(Default, Clone)]
struct Row {
    first: Count,
    exact: Count,
    silent: Count,
    adequate: Count,
    unknown: Count,
    modest: Count,
    covered: Count,
}

impl Row {
    fn add(&mut self, score: &Score) {
        let counts = [
            (&mut self.first, score.first),
            (&mut self.exact, score.exact),
            (&mut self.silent, score.silent),
            (&mut self.adequate, score.adequate),
            (&mut self.unknown, score.unknown),
            (&mut self.modest, score.modest),
        ];
        counts.into_iter().for_each(|(count, hit)| {
            hit.map(|hit| count.add(hit));
        });
        score.covered.iter().for_each(|covered| {
            self.covered.add(covered.is_inside());
        });
    }

    fn show(&self) -> String {
        let counts = [self.first, self.exact, self.silent, self.adequate, self.unknown, self.modest, self.covered];
        counts.map(Count::show).join(" | ")
    }
}

fn report(
    title: &str,
    cases: impl Iterator<Item = Result<Case, Box<dyn Error>>>,
    quiet: bool,
) -> Result<(), Box<dyn Error>> {
    let mut kinds: BTreeMap<String, Row> = BTreeMap::new();
    let mut styles: BTreeMap<String, Row> = BTreeMap::new();
    let mut parameters: BTreeMap<String, Count> = BTreeMap::new();
    for case in cases {
        let case = case?;
        let score = score(&case)?;
        kinds.entry(case.answer.kind.clone()).or_default().add(&score);
        styles.entry(format!("{}, {}", case.answer.kind, case.answer.style)).or_default().add(&score);
        for covered in &score.covered {
            let name = format!("{} {}", case.answer.kind, covered.name);
            parameters.entry(name).or_default().add(covered.is_inside());
        }
        if !quiet {
            println!("{:60} {:34} {}", case.name, marks(&case, &score), score.found);
        }
    }
    println!("\n{title}\n");
    for rows in [&kinds, &styles] {
        println!(
            "| | first | exact | null: nothing named | null: adequate | unknown | not identifiable: nothing wrong | 95 % intervals |"
        );
        println!("|{}", " --- |".repeat(8));
        rows.iter().for_each(|(name, row)| println!("| {name} | {} |", row.show()));
        println!();
    }
    parameters.iter().for_each(|(name, count)| println!("interval of {name}: {}", count.show()));
    Ok(())
}

fn marks(case: &Case, score: &Score) -> String {
    let of = [
        ("first", score.first),
        ("exact", score.exact),
        ("null", score.silent),
        ("adequate", score.adequate),
        ("unknown", score.unknown),
        ("modest", score.modest),
    ];
    let missed: Vec<&str> = of.iter().filter(|(_, hit)| *hit == Some(false)).map(|(name, _)| *name).collect();
    let outside = score.covered.iter().filter(|covered| !covered.is_inside());
    let outside: Vec<String> = outside.map(|covered| format!("{} {:+.1}", covered.name, covered.distance())).collect();
    let weak = if case.answer.identifiable { "" } else { "(weak) " };
    let wrong = if missed.is_empty() { "ok".to_owned() } else { format!("MISSED {}", missed.join(" ")) };
    if outside.is_empty() { format!("{weak}{wrong}") } else { format!("{weak}{wrong}, outside {}", outside.join(" ")) }
}
