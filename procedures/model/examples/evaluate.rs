//! Scores the model on measurements with a hidden effect: `cargo run --release -p jointbench-model --example evaluate
//! [FOLDER] [name-part]`. Every folder below holds run.csv.gz, meta.json and answer.json. A folder that holds a run
//! without an answer is diagnosed and shown.

use jointbench_instrument::{Channel, Meta, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, Verdict, diagnose, discover};
use serde_json::Value;
use std::error::Error;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Hits and cases of one figure.
#[derive(Default, Clone, Copy)]
struct Count(usize, usize);

impl Count {
    fn add(&mut self, hit: bool) -> bool {
        self.0 += usize::from(hit);
        self.1 += 1;
        hit
    }
}

#[derive(Default)]
struct Score {
    top1: Count,
    exact: Count,
    null: Count,
    unknown: Count,
    floor: Count,
    slowest_s: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/hidden-effects");
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| default.into()));
    let part = std::env::args().nth(2).unwrap_or_default();
    if !folder.is_dir() {
        println!("skipped: {} is not there", folder.display());
        return Ok(());
    }
    if folder.join("meta.json").is_file() && !folder.join("answer.json").is_file() {
        return show(&folder);
    }
    let mut cases: Vec<PathBuf> = std::fs::read_dir(&folder)?.filter_map(|e| Some(e.ok()?.path())).collect();
    cases.retain(|c| c.join("answer.json").is_file() && c.to_string_lossy().contains(&part));
    cases.sort();
    let mut score = Score::default();
    for case in &cases {
        judge(case, &mut score)?;
    }
    let Score { top1, exact, null, unknown, floor, slowest_s } = score;
    println!(
        "top-1 {}/{}  exact {}/{}  null {}/{}  unknown {}/{}  floor {}/{}  slowest diagnosis {slowest_s:.3} s",
        top1.0, top1.1, exact.0, exact.1, null.0, null.1, unknown.0, unknown.1, floor.0, floor.1
    );
    Ok(())
}

/// One run without an answer: what is found, step by step.
fn show(folder: &Path) -> Result<(), Box<dyn Error>> {
    let run = read(folder)?;
    let start = Instant::now();
    let first = diagnose(&run, &ModelSpec::baseline(&run)?, &Options::default())?;
    println!("{} ({:.3} s)", first.summary, start.elapsed().as_secs_f64());
    for s in &first.suggestions {
        println!(
            "  {} {:+.1} % p {:.3}, tied with {:?}",
            s.effect,
            -100.0 * s.error_reduction,
            s.p_value,
            s.confounded_with
        );
    }
    first.regions.iter().take(3).for_each(|r| println!("  {}", r.sentence));
    first.not_visible.iter().for_each(|n| println!("  not visible: {} ({})", n.effect, n.why));
    let whole = discover(&run, &ModelSpec::baseline(&run)?, &Options::default(), 6, |_| {})?;
    for s in &whole.steps {
        println!("  {:24} rms {:.4e} held out {:.4e}", s.added.as_deref().unwrap_or("-"), s.rms, s.validation_rms);
    }
    for p in &whole.fit.parameters {
        println!("  {}.{} = {:.5} {} [{:.5}, {:.5}]", p.effect, p.name, p.value, p.unit, p.ci95[0], p.ci95[1]);
    }
    println!("  relative error {:.3} %; {}", 100.0 * whole.fit.relative_error, whole.summary);
    Ok(())
}

fn judge(case: &Path, score: &mut Score) -> Result<(), Box<dyn Error>> {
    let run = read(case)?;
    let answer: Value = serde_json::from_str(&std::fs::read_to_string(case.join("answer.json"))?)?;
    let spec = ModelSpec::baseline(&run)?;
    let options = Options::default();
    let start = Instant::now();
    let first = diagnose(&run, &spec, &options)?;
    let took_s = start.elapsed().as_secs_f64();
    score.slowest_s = score.slowest_s.max(took_s);
    let whole = discover(&run, &spec, &options, 6, |_| {})?;
    let names: Vec<&str> = first.suggestions.iter().map(|s| s.effect.as_str()).collect();
    let added: Vec<&str> = whole.model.iter().map(String::as_str).filter(|e| !spec.contains(e)).collect();
    let mark = match answer["verdict"].as_str() {
        Some("adequate") => {
            let right = first.verdict == Verdict::Adequate && names.is_empty() && added.is_empty();
            if score.null.add(right) { "ok".into() } else { "FALSE ALARM".into() }
        }
        Some("unexplained_structure") => {
            let right = whole.verdict == Verdict::UnexplainedStructure;
            if score.unknown.add(right) { "ok".into() } else { "MISSED".into() }
        }
        _ => {
            let groups: Vec<Vec<String>> = serde_json::from_value(answer["accept"].clone())?;
            let optional: Vec<String> = serde_json::from_value(answer["optional"].clone()).unwrap_or_default();
            let is_in = |name: &str, group: &[String]| group.iter().any(|g| g == name);
            let hidden = |name: &str| groups.iter().any(|g| is_in(name, g));
            let must = added.iter().filter(|n| hidden(n) || !is_in(n, &optional)).count();
            let top = score.top1.add(names.first().is_some_and(|n| hidden(n)));
            let all = groups.iter().all(|g| added.iter().any(|n| is_in(n, g)));
            let exact = score.exact.add(all && must == groups.len());
            let ends_s = whole.steps.last().map_or(f64::INFINITY, |s| s.validation_rms);
            let floor = score.floor.add(exact && ends_s <= 1.1 * whole.noise_floor_rms.unwrap_or(0.0));
            [("top1", top), ("exact", exact), ("floor", floor)]
                .iter()
                .map(|(name, hit)| if *hit { format!("{name} ") } else { format!("NO-{name} ") })
                .collect::<String>()
        }
    };
    println!(
        "{:40} {:28} {:32} {:10.3e} / {:9.3e} {:22} {took_s:6.3} s  {mark}",
        case.file_name().unwrap_or_default().to_string_lossy(),
        names.join(","),
        added.join("+"),
        whole.steps.last().map_or(0.0, |s| s.validation_rms),
        whole.noise_floor_rms.unwrap_or(0.0),
        serde_json::to_value(whole.verdict)?.as_str().unwrap_or_default(),
    );
    Ok(())
}

/// Reads one case.
fn read(folder: &Path) -> Result<RunTable, Box<dyn Error>> {
    let meta: Meta = serde_json::from_str(&std::fs::read_to_string(folder.join("meta.json"))?)?;
    let mut text = Vec::new();
    match std::fs::File::open(folder.join("run.csv.gz")) {
        Ok(file) => flate2::read::GzDecoder::new(file).read_to_end(&mut text)?,
        Err(_) => std::fs::File::open(folder.join("run.csv"))?.read_to_end(&mut text)?,
    };
    let mut reader = csv::Reader::from_reader(text.as_slice());
    let channels: Vec<Channel> = reader.headers()?.iter().map(Channel::new).collect();
    let mut columns = vec![Vec::new(); channels.len()];
    for record in reader.into_records() {
        for (column, field) in columns.iter_mut().zip(record?.iter()) {
            column.push(field.parse()?);
        }
    }
    Ok(RunTable::new(meta, Trace::from_columns(channels, columns))?)
}
