//! Compares the answers of `diagnose` and `discover` with the correct ones.

use crate::common;
use crate::made::{Answer, Case};
use jointbench_model::{ModelSpec, Options, Verdict, diagnose, discover};
use serde_json::Value;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

/// Hits and cases of one figure.
#[derive(Default, Clone, Copy)]
pub struct Count(pub usize, pub usize);

impl Count {
    pub fn add(&mut self, hit: bool) -> bool {
        self.0 += usize::from(hit);
        self.1 += 1;
        hit
    }

    fn join(&mut self, more: Count) {
        (self.0, self.1) = (self.0 + more.0, self.1 + more.1);
    }

    pub fn show(self) -> String {
        let share = self.0 as f64 / self.1 as f64;
        if self.1 == 0 { "–".into() } else { format!("{share:.2} ({}/{})", self.0, self.1) }
    }
}

const FIGURES: [&str; 5] = ["top-1", "exact", "null", "unknown", "floor"];

/// Figures of each family, and the number of unknown cases in which a library effect is named in addition to the
/// structure.
pub struct Table {
    title: &'static str,
    quiet: bool,
    rows: Vec<(&'static str, [Count; 5], Count)>,
    slowest_s: f64,
}

impl Table {
    pub fn new(title: &'static str, quiet: bool) -> Self {
        Self { title, quiet, rows: Vec::new(), slowest_s: 0.0 }
    }

    /// One case: its result, and the figures that it counts for.
    pub fn judge(&mut self, case: &Case) -> Result<(), Box<dyn Error>> {
        let Case { family, name, run, answer } = case;
        let spec = ModelSpec::baseline(run)?;
        let start = Instant::now();
        let first = diagnose(run, &spec, &Options::default())?;
        let took_s = start.elapsed().as_secs_f64();
        self.slowest_s = self.slowest_s.max(took_s);
        let whole = discover(run, &spec, &Options::default(), 6)?;
        let names: Vec<&str> = first.suggestions.iter().map(|s| s.effect.as_str()).collect();
        let added: Vec<&str> = whole.model.iter().map(String::as_str).filter(|e| !spec.contains(e)).collect();
        let hidden = |id: &str| answer.accept.iter().any(|g| g.iter().any(|a| a == id));
        let end = whole.steps.last().map_or(f64::INFINITY, |s| s.validation_rms);
        let mut hits = [None; 5];
        if answer.unknown {
            hits[3] = Some(whole.verdict == Verdict::UnexplainedStructure);
        } else if answer.accept.is_empty() {
            hits[2] = Some(first.verdict == Verdict::Adequate && names.is_empty() && added.is_empty());
        } else {
            let all = answer.accept.iter().all(|g| added.iter().any(|a| g.iter().any(|id| id == a)));
            let counted = added.iter().filter(|a| hidden(a) || !answer.optional.iter().any(|o| o == *a)).count();
            let exact = all && counted == answer.accept.len();
            hits[0] = Some(names.first().is_some_and(|n| hidden(n)));
            hits[1] = Some(exact);
            hits[4] = Some(exact && end <= 1.1 * whole.noise_floor_rms.unwrap_or(0.0));
        }
        let row = match self.rows.iter().position(|r| r.0 == *family) {
            Some(at) => at,
            None => {
                self.rows.push((family, Default::default(), Count::default()));
                self.rows.len() - 1
            }
        };
        if answer.unknown {
            let is_false = |id: &&str| !answer.optional.iter().any(|o| o == id);
            self.rows[row].2.add(names.iter().chain(&added).any(is_false));
        }
        for (figure, hit) in self.rows[row].1.iter_mut().zip(hits) {
            if let Some(hit) = hit {
                figure.add(hit);
            }
        }
        let missed: Vec<&str> = FIGURES.iter().zip(hits).filter(|(_, h)| *h == Some(false)).map(|(f, _)| *f).collect();
        if !self.quiet {
            println!(
                "{name:44} {:30} {:34} {end:9.3e} / {:9.3e} {:22} {took_s:6.3} s  {}",
                names.join(","),
                added.join("+"),
                whole.noise_floor_rms.unwrap_or(0.0),
                serde_json::to_value(whole.verdict)?.as_str().unwrap_or_default(),
                if missed.is_empty() { "ok".into() } else { format!("MISSED {}", missed.join(" ")) },
            );
        }
        Ok(())
    }

    pub fn print(mut self) {
        let (mut all, mut all_false) = ([Count::default(); 5], Count::default());
        for (_, row, named) in &self.rows {
            all.iter_mut()
                .chain([&mut all_false])
                .zip(row.iter().chain([named]))
                .for_each(|(all, count)| all.join(*count));
        }
        self.rows.push(("all", all, all_false));
        println!(
            "\n{} (slowest diagnosis {:.3} s)\n\n| family | {} | false names in unknown |",
            self.title,
            self.slowest_s,
            FIGURES.join(" | ")
        );
        println!("| --- |{}", " --- |".repeat(FIGURES.len() + 1));
        for (family, row, named) in &self.rows {
            println!("| {family} | {} | {} |", row.map(Count::show).join(" | "), named.show());
        }
        println!();
    }
}

/// Cases from next to the repository: run, meta file and answer.
pub fn practice(folder: &Path) -> Result<Vec<Case>, Box<dyn Error>> {
    let mut folders: Vec<_> = std::fs::read_dir(folder)?.filter_map(|e| Some(e.ok()?.path())).collect();
    folders.retain(|f| f.join("answer.json").is_file());
    folders.sort();
    let case = |folder: &Path| -> Result<Case, Box<dyn Error>> {
        let answer: Value = serde_json::from_str(&std::fs::read_to_string(folder.join("answer.json"))?)?;
        let run = common::read(folder);
        let unknown = answer["verdict"] == "unexplained_structure";
        let accept = if unknown { Vec::new() } else { serde_json::from_value(answer["accept"].clone())? };
        let optional = serde_json::from_value(answer["optional"].clone()).unwrap_or_default();
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Case { family: run.kind().name(), name, run, answer: Answer { accept, optional, unknown } })
    };
    folders.iter().map(|f| case(f)).collect()
}
