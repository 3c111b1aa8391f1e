//! Coverage of 95 % intervals: `cargo run --release -p jointbench-model --example coverage [SETS] [CASE-PART]`.
//!
//! Every set is a simulated run with coloured noise (AR(1), 0.85 from sample to sample) and segments with a separate
//! offset, tilt and direction-dependent offset. The library does not contain the formulas of the truth. Parameters
//! that are at bound or unidentified are counted separately, because their state is the answer, not their interval.
//! Fits with another form of the effect are counted separately, too.

mod cases;
mod noise;

use cases::{CASES, Case};
use jointbench_model::{ModelSpec, Options, ParameterState, diagnose, fit};
use std::error::Error;

/// Results of one parameter over all sets.
#[derive(Default)]
struct Seen {
    inside: usize,
    judged: usize,
    in_words: usize,
    other_form: usize,
    half_widths: Vec<f64>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let sets: u64 = std::env::args().nth(1).map_or(Ok(400), |n| n.parse())?;
    let part = std::env::args().nth(2).unwrap_or_default();
    println!(
        "{:34} {:30} {:>9} {:>8} {:>9} {:>10} {:>12}",
        "case", "parameter", "coverage", "judged", "in words", "other form", "half width"
    );
    let (mut linear, mut curved) = (Seen::default(), Seen::default());
    for case in CASES.iter().filter(|c| c.name.contains(&part)) {
        let seen = study(case, sets)?;
        for ((effect, name, truth), seen) in case.truth.iter().zip(&seen) {
            let mut widths = seen.half_widths.clone();
            widths.sort_by(f64::total_cmp);
            let half = widths.get(widths.len() / 2).copied().unwrap_or(f64::NAN) / truth.abs();
            println!(
                "{:34} {:30} {:>8.1}% {:>8} {:>9} {:>10} {:>10.2} %",
                case.name,
                format!("{effect}.{name}"),
                100.0 * seen.inside as f64 / seen.judged.max(1) as f64,
                seen.judged,
                seen.in_words,
                seen.other_form,
                100.0 * half
            );
            let pool = if case.curved.contains(name) { &mut curved } else { &mut linear };
            pool.inside += seen.inside;
            pool.judged += seen.judged;
        }
    }
    for case in CASES.iter().filter(|c| c.name.contains(&part)) {
        floor(case, sets.min(FLOOR_SETS))?;
    }
    for (name, pool) in [("linear", linear), ("nonlinear", curved)] {
        let share = 100.0 * pool.inside as f64 / pool.judged.max(1) as f64;
        println!("{name} parameters pooled: {share:.1} % of {}", pool.judged);
    }
    Ok(())
}

/// A diagnosis takes longer than a fit.
const FLOOR_SETS: u64 = 100;

/// Coverage of the noise-floor interval for the mean floor over all sets.
fn floor(case: &Case, sets: u64) -> Result<(), Box<dyn Error>> {
    let mut floors = Vec::new();
    for seed in 0..sets {
        let run = (case.run)(seed)?;
        let spec = ModelSpec::new(run.kind(), case.effects.iter().copied())?;
        let found = diagnose(&run, &spec, &Options { flips: 99, ..Options::default() })?.noise_floor;
        floors.extend(found.rms.zip(found.ci95));
    }
    let mean = (floors.iter().map(|(rms, _)| rms * rms).sum::<f64>() / floors.len().max(1) as f64).sqrt();
    let inside = floors.iter().filter(|(_, ci)| (ci[0]..=ci[1]).contains(&mean)).count();
    let share = 100.0 * inside as f64 / floors.len().max(1) as f64;
    println!("{:34} noise floor {share:>27.1}% of {} runs with repeats", case.name, floors.len());
    Ok(())
}

fn study(case: &Case, sets: u64) -> Result<Vec<Seen>, Box<dyn Error>> {
    let mut seen: Vec<Seen> = case.truth.iter().map(|_| Seen::default()).collect();
    for seed in 0..sets {
        let run = (case.run)(seed)?;
        let spec = ModelSpec::new(run.kind(), case.effects.iter().copied())?;
        let found = fit(&run, &spec, &Options::default())?;
        let is_other =
            |(effect, form): &(&str, &str)| found.terms.iter().any(|t| t.effect == *effect && t.form != *form);
        if case.forms.iter().any(is_other) {
            seen.iter_mut().for_each(|s| s.other_form += 1);
            continue;
        }
        for ((effect, name, truth), seen) in case.truth.iter().zip(&mut seen) {
            match found.parameters.iter().find(|p| p.effect == *effect && p.name == *name) {
                None => return Err(format!("{}: no parameter {effect}.{name}", case.name).into()),
                Some(p)
                    if p.state != ParameterState::Ok
                        && p.note.as_deref() != Some("not identified by this run: its interval includes zero") =>
                {
                    seen.in_words += 1;
                }
                Some(p) => {
                    seen.judged += 1;
                    seen.inside += usize::from((p.ci95[0]..=p.ci95[1]).contains(truth));
                    seen.half_widths.push((p.ci95[1] - p.ci95[0]) / 2.0);
                }
            }
        }
    }
    Ok(seen)
}
