//! State of every row of the documents, from what this reproduction has measured.

use super::evidence::Evidence;
use super::figure::Figure;
use super::performed::{Answered, Performed};
use super::row::Row;
use crate::report::with_interval;
use jointbench_devices::sim::HIDDEN_EFFECTS;
use jointbench_model::effects;
use jointbench_procedure::identification::Verdict;
use std::fmt::{self, Write};

pub const COLUMNS: &str = "| kind | item | state | document | measured | shown by | missing |";
/// More figures in a row are counted, not listed.
const LISTED: usize = 3;

/// What the reproduction has measured.
#[derive(Default)]
pub struct Measured {
    pub figures: Vec<Figure>,
    pub seeds: u64,
    pub performed: Vec<Performed>,
    pub answered: Vec<Answered>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    Works,
    Partly,
    Missing,
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            State::Works => "works",
            State::Partly => "**partly**",
            State::Missing => "**missing**",
        })
    }
}

/// One piece of evidence, judged.
#[derive(Default)]
struct Judged {
    /// What does not hold; empty if all holds.
    wrong: Vec<String>,
    measured: Vec<String>,
    /// Values of the document.
    document: Vec<String>,
}

/// A row with its state.
pub struct JudgedRow<'a> {
    pub row: &'a Row,
    pub state: State,
    document: String,
    measured: String,
    missing: String,
}

impl Measured {
    pub fn judge<'a>(&self, row: &'a Row) -> JudgedRow<'a> {
        let judged: Vec<Judged> = row.evidence.iter().map(|evidence| self.judge_one(evidence)).collect();
        let holds = |one: &Judged| one.wrong.is_empty();
        let is_measured = row.evidence.iter().any(Evidence::is_figure);
        let state = match (judged.iter().all(holds), judged.iter().any(holds) || is_measured) {
            (true, true) if row.missing.is_empty() => State::Works,
            (_, true) => State::Partly,
            (_, false) => State::Missing,
        };
        let all = |part: fn(&Judged) -> &Vec<String>| -> Vec<&str> {
            judged.iter().flat_map(part).map(String::as_str).collect()
        };
        let (documents, wrong) = (all(|one| &one.document), all(|one| &one.wrong));
        let document = match (row.figure, documents.len()) {
            ("", 1..=LISTED) => documents.join(", "),
            ("", 1..) => format!("{} figures", documents.len()),
            (figure, _) => figure.to_owned(),
        };
        let missing: Vec<&str> = [row.missing].into_iter().filter(|text| !text.is_empty()).chain(wrong).collect();
        JudgedRow { row, state, document, measured: all(|one| &one.measured).join("; "), missing: missing.join("; ") }
    }

    fn judge_one(&self, evidence: &Evidence) -> Judged {
        match evidence {
            Evidence::Figures { bench, names } => self.judge_figures(bench, names),
            Evidence::Run { run, results } => {
                let Some(done) = self.performed.iter().find(|done| done.run == *run) else {
                    return Judged::wrong(format!("{}: not run", run.procedure));
                };
                judge_run(done, results)
            }
            Evidence::Driver { bench, role, driver } => {
                let is_it = |one: &&Answered| {
                    (one.bench.as_str(), one.role, one.driver) == (bench.as_str(), role.as_str(), driver.as_str())
                };
                match self.answered.iter().find(is_it) {
                    Some(answered) => Judged::measured(format!("{} answers", answered.model)),
                    None => Judged::wrong(format!("no {driver} answers as {role}")),
                }
            }
            Evidence::Effect { kind, id } => {
                let is_hidden = HIDDEN_EFFECTS.iter().any(|(of, all)| of == kind && all.contains(&id.as_str()));
                let where_it_is = if is_hidden { "in the library and in mock benches" } else { "in the library" };
                match effects(*kind).iter().any(|effect| effect.info().id == id.as_str()) {
                    true => Judged::measured(format!("{id} {where_it_is}")),
                    false => Judged::wrong(format!("no effect {id}")),
                }
            }
            // A unit test verifies that the named test exists.
            Evidence::Test { .. } => Judged::default(),
        }
    }

    fn judge_figures(&self, bench: &str, names: &[String]) -> Judged {
        let mut judged = Judged::default();
        let (mut held, mut outside) = (0, Vec::new());
        for name in names {
            let Some(figure) = self.figures.iter().find(|one| one.bench == bench && one.one.found.name == *name) else {
                outside.push(format!("{name} not measured"));
                continue;
            };
            judged.document.push(figure.document());
            let (holds, text) = held_figure(figure, self.seeds);
            held += usize::from(holds);
            if !holds {
                outside.push(format!("{name} {}", share(figure, self.seeds)));
            }
            if names.len() <= LISTED {
                judged.measured.push(format!("{name} {text}"));
            }
        }
        if !outside.is_empty() {
            judged.wrong.push(format!("{bench}: {}", outside.join(", ")));
        }
        if names.len() > LISTED {
            judged.measured.push(format!("{bench}: {held} of {} hold", names.len()));
        }
        judged
    }
}

/// Whether a figure holds, and its measured value. A figure without an interval holds if the values of all seeds
/// enclose the value of the document.
fn held_figure(figure: &Figure, seeds: u64) -> (bool, String) {
    let (value, width) = figure.measured();
    match (figure.holds(seeds), width) {
        (Some(holds), Some(width)) => (holds, format!("{value} ± {width} ({} of {seeds})", figure.inside)),
        _ => {
            let [low, high] = ends(figure);
            let holds = figure.one.document.is_some_and(|document| (low..=high).contains(&document));
            (holds, format!("{value} ({} … {} over the seeds)", figure.shown(low), figure.shown(high)))
        }
    }
}

fn ends(figure: &Figure) -> [f64; 2] {
    let fold = |start, choose: fn(f64, f64) -> f64| figure.values.iter().copied().fold(start, choose);
    [fold(f64::INFINITY, f64::min), fold(f64::NEG_INFINITY, f64::max)]
}

/// How far a figure does not hold.
fn share(figure: &Figure, seeds: u64) -> String {
    match figure.holds(seeds) {
        Some(_) => format!("inside in {} of {seeds}", figure.inside),
        None => "outside the range of all seeds".into(),
    }
}

fn judge_run(done: &Performed, results: &[String]) -> Judged {
    let procedure = &done.run.procedure;
    let found = match &done.result {
        Err(why) => return Judged::wrong(why.replace('|', "/")),
        Ok(found) => found,
    };
    let mut judged = Judged::default();
    let has_interval = |name: &String| found.quantity(name).is_some_and(|quantity| quantity.ci95.is_some());
    match found.verdict {
        Verdict::Identified => {}
        Verdict::Inconclusive if !results.is_empty() && results.iter().all(has_interval) => {
            judged.measured.push(format!("{procedure} is inconclusive"));
        }
        _ => judged.wrong.push(format!("{procedure} is not identified")),
    }
    for name in results {
        match found.quantity(name) {
            Some(quantity) => {
                let (value, interval) = with_interval(quantity.value, quantity.ci95, &quantity.unit);
                let interval = interval.map(|ends| format!(" [{ends}]")).unwrap_or_default();
                judged.measured.push(format!("{name} {value}{interval}"));
            }
            None if found.figures.iter().any(|figure| figure.name == *name) => {}
            None => judged.wrong.push(format!("{procedure} gives no {name}")),
        }
    }
    if results.is_empty() {
        judged.measured.push(format!("{procedure} is identified"));
    }
    judged
}

impl Judged {
    fn wrong(why: String) -> Self {
        Self { wrong: vec![why], ..Self::default() }
    }

    fn measured(what: String) -> Self {
        Self { measured: vec![what], ..Self::default() }
    }
}

/// The part of a page's line that is the same in every reproduction.
pub fn fixed_cells(row: &Row) -> [String; 2] {
    let shown_by: Vec<String> = row.evidence_texts().map(|text| format!("`{text}`")).collect();
    [format!("| {} | {} | ", row.kind, row.item), format!(" | {} | ", shown_by.join(", "))]
}

/// The tables of all rows, by section.
pub fn tables(judged: &[JudgedRow]) -> String {
    let count = |state| judged.iter().filter(|one| one.state == state).count();
    let [works, partly, missing] = [State::Works, State::Partly, State::Missing].map(count);
    let mut text = format!(
        "## Rows of the documents\n\nEvery system, instrument, procedure, table, model and effect of the documents. A row *works* if all its evidence holds: a figure in at least 90 % of the seeds; a run on the bench of the first seed that is identified, or inconclusive with an interval of each named quantity; an instrument that responds to its driver; an effect of the library; a test of the project. A figure without interval holds if the values of the seeds enclose that of the document. Intervals of runs are in brackets.\n\nOf {} rows {works} work, {partly} work partly, {missing} are missing.\n",
        judged.len()
    );
    for section in judged.chunk_by(|a, b| a.row.section == b.row.section) {
        let _ = writeln!(text, "\n### {}\n\n{COLUMNS}\n|---|---|---|---|---|---|---|", section[0].row.section);
        for JudgedRow { row, state, document, measured, missing } in section {
            let [first, shown_by] = fixed_cells(row);
            let _ = writeln!(text, "{first}{state} | {document} | {measured}{shown_by}{missing} |");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::figure::count;
    use super::*;
    use jointbench_procedure::identification::{Identification, Quantity};
    use jointbench_procedure::reproduce::Comparison;

    fn quantity(name: &str, value: f64, ci95: Option<[f64; 2]>) -> Quantity {
        let (name, unit) = (name.to_owned(), "Nm".to_owned());
        Quantity {
            name,
            symbol: String::new(),
            title: String::new(),
            base_title: None,
            base_symbol: None,
            configuration: None,
            direction: None,
            unit,
            value,
            ci95,
        }
    }

    /// Ten seeds: `value` is inside in nine, `rare` in eight, `bare` has no interval.
    fn measured() -> Measured {
        let mut measured = Measured { seeds: 10, ..Measured::default() };
        for seed in 0..10 {
            let near = |missed| if seed < missed { 2.0 } else { 1.0 };
            for (name, value, has_interval) in
                [("value", near(1), true), ("rare", near(2), true), ("bare", near(1), false), ("far", 2.0, false)]
            {
                let ci95 = has_interval.then_some([value - 0.1, value + 0.1]);
                let found = quantity(name, value, ci95);
                let one = Comparison { table: "1", found, document: Some(1.05), given: None, demand: None };
                count(&mut measured.figures, "Joint A", &one);
            }
        }
        measured
    }

    fn row(evidence: &[&str], missing: &'static str) -> Row {
        let evidence = evidence.iter().map(|text| Evidence::parse(text).unwrap()).collect();
        Row::new(evidence, missing)
    }

    #[test]
    fn figures_decide_by_the_fraction_of_seeds() {
        let measured = measured();
        for (evidence, missing, expected) in [
            ("figure Joint A: value", "", State::Works),
            ("figure Joint A: value", "another range", State::Partly),
            ("figure Joint A: value, rare", "", State::Partly),
            ("figure Joint A: rare", "", State::Partly),
            ("figure Joint A: bare", "", State::Works),
            ("figure Joint A: far", "", State::Partly),
        ] {
            assert_eq!(measured.judge(&row(&[evidence], missing)).state, expected, "{evidence}");
        }
        let rare = row(&["figure Joint A: rare"], "");
        assert_eq!(measured.judge(&rare).missing, "Joint A: rare inside in 8 of 10");
    }

    #[test]
    fn a_run_has_to_be_identified_with_its_results() {
        let mut measured = measured();
        let verdicts = [Verdict::Identified, Verdict::Inconclusive];
        for (verdict, procedure) in verdicts.into_iter().zip(["friction", "breakaway"]) {
            let Some(Evidence::Run { run, .. }) = Evidence::parse(&format!("run Joint A: {procedure}")) else {
                panic!()
            };
            let quantities = vec![quantity("tau_c", 0.03, Some([0.029, 0.031]))];
            let result = Ok(Identification { verdict, quantities, ..Identification::default() });
            measured.performed.push(Performed { run, result });
        }
        for (evidence, expected) in [
            (["run Joint A: friction > tau_c"].as_slice(), State::Works),
            (&["run Joint A: friction > tau_h"], State::Missing),
            (&["run Joint A: breakaway > tau_c"], State::Works),
            (&["run Joint A: breakaway"], State::Missing),
            (&["run Joint A: presliding"], State::Missing),
            (&["run Joint A: friction", "driver Joint A: joint odrive"], State::Partly),
            (&["effect friction: coulomb"], State::Works),
            (&[], State::Missing),
        ] {
            assert_eq!(measured.judge(&row(evidence, "")).state, expected, "{evidence:?}");
        }
        assert_eq!(
            measured.judge(&row(&["run Joint A: friction > tau_c"], "")).measured,
            "tau_c 30.00 mNm [29.00 … 31.00]"
        );
    }
}
