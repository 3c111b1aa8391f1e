//! One case against its answer, and the table of all.

use crate::common::read;
use jointbench_model::{Diagnosis, Discovery, ModelSpec, Options, Verdict, diagnose, discover};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

#[derive(Deserialize)]
pub struct Answer {
    #[serde(default, alias = "family")]
    pub kind: String,
    #[serde(default)]
    category: String,
    #[serde(default)]
    style: String,
    hidden: Vec<String>,
    #[serde(default)]
    acceptable: BTreeMap<String, Vec<String>>,
    #[serde(default)]
    accept: Vec<Vec<String>>,
    #[serde(default)]
    optional: Vec<String>,
    #[serde(default = "yes")]
    identifiable: bool,
    #[serde(default)]
    truth: BTreeMap<String, f64>,
    #[serde(default)]
    verdict: String,
}

fn yes() -> bool {
    true
}

impl Answer {
    pub fn read(case: &Path) -> Result<Self, Box<dyn Error>> {
        let mut answer: Self = serde_json::from_str(&std::fs::read_to_string(case.join("answer.json"))?)?;
        if answer.category.is_empty() {
            answer.category = match answer.verdict.as_str() {
                "unexplained_structure" => "unknown",
                "adequate" => "null",
                _ => "hidden",
            }
            .into();
            answer.style = "steps".into();
        }
        if answer.acceptable.is_empty() && answer.category != "unknown" {
            answer.acceptable = answer.hidden.iter().cloned().zip(answer.accept.clone()).collect();
        }
        Ok(answer)
    }
}

/// What was answered to a case.
pub struct Judged {
    name: String,
    answer: Answer,
    told: Result<Told, String>,
    took_s: f64,
}

struct Told {
    named: Vec<String>,
    /// Share of the held-out RMS that each takes alone, and how likely chance would bring that.
    evidence: String,
    added: Vec<String>,
    verdict: Verdict,
    residual: String,
    /// Error by the floor.
    over: Option<f64>,
    /// Parameters with a truth, and whether their intervals hold it.
    held: Vec<(String, bool, f64)>,
    seconds: f64,
}

impl Judged {
    pub fn new(case: &Path, answer: Answer) -> Self {
        let start = Instant::now();
        let told = Told::new(case, &answer).map_err(|error| error.to_string());
        let name = case.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Self { name, answer, told, took_s: start.elapsed().as_secs_f64() }
    }

    /// What counts for this case, with whether it was met.
    fn checks(&self) -> Vec<(&'static str, bool)> {
        let Ok(told) = &self.told else {
            return match self.answer.category.as_str() {
                "null" => vec![("null", false), ("adequate", false)],
                "unknown" => vec![("unknown", false)],
                _ => vec![("top1", false), ("exact", false)],
            };
        };
        let is_known = |id: &String| self.answer.acceptable.values().any(|group| group.contains(id));
        let extra: Vec<&String> = told.added.iter().filter(|id| !self.answer.optional.contains(id)).collect();
        match self.answer.category.as_str() {
            "null" => vec![
                ("null", told.named.is_empty() && extra.is_empty()),
                ("adequate", told.verdict == Verdict::Adequate),
            ],
            "unknown" => vec![("unknown", told.verdict == Verdict::UnexplainedStructure)],
            _ => {
                let groups: Vec<&Vec<String>> = self.answer.acceptable.values().collect();
                vec![
                    ("top1", told.named.first().is_some_and(is_known)),
                    ("exact", is_exact(&groups, &told.added, &self.answer.optional)),
                ]
            }
        }
    }

    pub fn line(&self) -> String {
        let hidden = match self.answer.hidden.is_empty() {
            true => self.answer.category.clone(),
            false => self.answer.hidden.join("+"),
        };
        let found = match &self.told {
            Ok(told) => {
                let or = |names: &[String]| if names.is_empty() { "-".into() } else { names.join("+") };
                let missed: Vec<String> =
                    told.held.iter().filter(|h| !h.1).map(|(name, _, off)| format!("{name}({off:.1})")).collect();
                format!(
                    "{} [{}] | {} | {:?} {} over floor {} {}",
                    or(&told.named),
                    told.evidence,
                    or(&told.added),
                    told.verdict,
                    told.residual,
                    told.over.map_or_else(|| "?".into(), |over| format!("{over:.2}")),
                    missed.join(" ")
                )
            }
            Err(error) => format!("ERROR {error}"),
        };
        let marks: Vec<String> = self
            .checks()
            .into_iter()
            .map(|(name, met)| if met { name.into() } else { format!("NOT-{name}") })
            .collect();
        let open = if self.answer.identifiable { "" } else { "(not identifiable) " };
        format!(
            "{:44} {:12} {hidden:34} -> {found} {open}{} {:.1}s",
            self.name,
            self.answer.style,
            marks.join(" "),
            self.took_s
        )
    }
}

/// Every hidden effect is met by one of the added ones, and nothing else was added but what may be.
fn is_exact(groups: &[&Vec<String>], added: &[String], optional: &[String]) -> bool {
    match groups.split_first() {
        None => added.iter().all(|id| optional.contains(id)),
        Some((group, others)) => added.iter().enumerate().any(|(at, id)| {
            let rest: Vec<String> =
                added.iter().enumerate().filter(|(i, _)| *i != at).map(|(_, id)| id.clone()).collect();
            group.contains(id) && is_exact(others, &rest, optional)
        }),
    }
}

impl Told {
    fn new(case: &Path, answer: &Answer) -> Result<Self, Box<dyn Error>> {
        let run = read(case);
        let spec = ModelSpec::baseline(&run)?;
        let start = Instant::now();
        let first: Diagnosis = diagnose(&run, &spec, &Options::default())?;
        let seconds = start.elapsed().as_secs_f64();
        let whole: Discovery = discover(&run, &spec, &Options::default(), 6, |_| {})?;
        let parameter = |key: &String| {
            let (effect, name) = key.split_once('.')?;
            whole.fit.parameters.iter().find(|p| p.effect == effect && p.name == name)
        };
        let held = answer.truth.iter().filter_map(|(key, truth)| {
            let p = parameter(key)?;
            let half = (p.ci95[1] - p.ci95[0]) / 2.0;
            Some((key.clone(), (p.ci95[0]..=p.ci95[1]).contains(truth), (p.value - truth) / half))
        });
        let evidence = first.suggestions.iter().map(|s| format!("{:.2}/{:.0e}", s.error_reduction, s.p_value));
        Ok(Self {
            named: first.suggestions.iter().map(|s| s.effect.clone()).collect(),
            evidence: evidence.collect::<Vec<_>>().join(" "),
            added: whole.model.iter().filter(|e| !spec.contains(e)).cloned().collect(),
            verdict: first.verdict,
            residual: format!("{:?}", first.residual),
            over: whole.noise_floor_rms.map(|floor| whole.fit.validation_rms / floor),
            held: held.collect(),
            seconds,
        })
    }
}

/// Hits and cases.
type Counts = BTreeMap<&'static str, (usize, usize)>;

#[derive(Default)]
pub struct Table {
    all: Counts,
    styles: BTreeMap<String, Counts>,
    held: BTreeMap<String, (usize, usize)>,
    seconds: f64,
}

impl Table {
    pub fn add(&mut self, case: &Judged) {
        let mut checks = case.checks();
        if !case.answer.identifiable {
            // Silence is right there, and so is the truth.
            let wrong = case.told.as_ref().is_ok_and(|told| {
                let known = |id: &String| {
                    case.answer.acceptable.values().any(|group| group.contains(id)) || case.answer.optional.contains(id)
                };
                !told.named.iter().all(known)
            });
            checks = vec![("unidentifiable, nothing wrong", !wrong)];
        }
        for (name, met) in &checks {
            for counts in [&mut self.all, self.styles.entry(case.answer.style.clone()).or_default()] {
                let count = counts.entry(name).or_default();
                *count = (count.0 + usize::from(*met), count.1 + 1);
            }
        }
        let Ok(told) = &case.told else { return };
        self.seconds = self.seconds.max(told.seconds);
        let is_right =
            checks.iter().all(|(name, met)| *met && (*name == "exact" || *name == "top1" || *name == "null"))
                || case.answer.category == "null" && checks.first().is_some_and(|c| c.1);
        if is_right {
            for (key, held, _) in &told.held {
                let count = self.held.entry(key.clone()).or_default();
                *count = (count.0 + usize::from(*held), count.1 + 1);
            }
        }
    }

    pub fn print(&self) {
        let names = ["top1", "exact", "null", "adequate", "unknown", "unidentifiable, nothing wrong"];
        println!("\n| style | {} |\n| --- |{}", names.join(" | "), " --- |".repeat(names.len()));
        let row = |title: &str, counts: &Counts| {
            let cell =
                |name: &&str| counts.get(*name).map_or_else(|| "–".into(), |(hits, all)| format!("{hits}/{all}"));
            println!("| {title} | {} |", names.iter().map(cell).collect::<Vec<_>>().join(" | "));
        };
        self.styles.iter().for_each(|(style, counts)| row(style, counts));
        row("all", &self.all);
        let (held, all) = self.held.values().fold((0, 0), |(a, b), (held, all)| (a + held, b + all));
        let each: Vec<String> = self.held.iter().map(|(key, (held, all))| format!("{key} {held}/{all}")).collect();
        println!("\n95 % intervals of right and null cases hold {held}/{all}: {}", each.join(", "));
        println!("slowest diagnosis {:.2} s", self.seconds);
    }
}
