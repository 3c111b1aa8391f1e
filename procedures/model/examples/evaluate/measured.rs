//! Published measurements, with the requirements on the diagnosis of each.

use crate::common::recordings::{BAM, EMPS, KR300, ODRIVE, PLACID, WAVES, most, of_pulses, recording, waves};
use crate::options::Asked;
use jointbench_model::{Discovery, ModelSpec, Options, Suggestion, diagnose, discover, fit, words};
use std::error::Error;
use std::path::Path;

/// The requirement, the result, and whether it is met.
type Judged = (&'static str, String, bool);

pub fn measure(data: &Path, asked: &Asked) -> Result<(), Box<dyn Error>> {
    println!("\nMeasurements made by others\n");
    println!("| recording | named first (tied with) | added in the end | validation error | required | found | met |");
    println!("|{}", " --- |".repeat(7));
    for folder in [EMPS, BAM].into_iter().chain(ODRIVE).chain([PLACID, KR300]) {
        if !data.join(folder).is_dir() {
            println!("| {folder} | skipped: it is not in {} | | | | | |", data.display());
            continue;
        }
        let run = recording(data, folder);
        if !asked.takes(run.kind().name(), folder) {
            continue;
        }
        let spec = ModelSpec::baseline(&run)?;
        let named = diagnose(&run, &spec, &Options::default())?.suggestions;
        let whole = discover(&run, &spec, &Options::default(), most(folder))?;
        let added: Vec<&str> = whole.model.iter().map(String::as_str).filter(|effect| !spec.contains(effect)).collect();
        let first = named.first().map_or_else(|| "–".to_owned(), with_ties);
        let errors = [whole.steps.first(), whole.steps.last()].map(|s| s.map_or(f64::NAN, |s| s.validation_rms));
        let (wanted, found, is_so) = match folder {
            EMPS => emps(data, &named, &added, &whole),
            BAM => bam(&named, errors),
            PLACID => placid(&named, &whole),
            KR300 => {
                let error = |more: &[&str]| -> Result<f64, Box<dyn Error>> {
                    let spec = more.iter().try_fold(spec.clone(), |spec, effect| spec.with(effect))?;
                    Ok(fit(&run, &spec, &Options::default())?.validation_rms)
                };
                let [compliance, position] =
                    [error(&["compliance"])?, error(&["compliance", "transmission_error"])?].map(mdeg);
                let delay = mdeg(errors[1]);
                let found = format!("{compliance}, then {position} in that order; {delay} with a delay first");
                ("compliance, then position terms", found, added.first() == Some(&"compliance"))
            }
            _ => odrive(&added, &whole),
        };
        let [before, after] = errors.map(|rms| words::figure(rms, &whole.fit.unit));
        println!(
            "| {folder} | {first} | {} | {before} → {after} | {wanted} | {found} | {} |",
            words::list(&added),
            if is_so { "yes" } else { "no" }
        );
    }
    println!();
    Ok(())
}

fn with_ties(first: &Suggestion) -> String {
    match first.confounded_with.as_slice() {
        [] => first.effect.clone(),
        ties => format!("{} ({})", first.effect, words::list(ties)),
    }
}

fn mdeg(radians: f64) -> String {
    format!("{:.1} mdeg", 1e3 * radians.to_degrees())
}

fn emps(data: &Path, named: &[Suggestion], added: &[&str], whole: &Discovery) -> Judged {
    let is_first = named.first().is_some_and(|first| {
        first.effect == "viscous_asymmetry" && first.confounded_with.iter().any(|tie| tie == "viscous_quadratic")
    });
    let unseen = of_pulses(data, &whole.fit);
    (
        "viscous_asymmetry, tied with v²; unseen pulses ≤ 2.8 % with at most 5 effects more",
        format!("{:.2} % with {} more", 100.0 * unseen, added.len()),
        is_first && unseen <= 0.028 && added.len() <= 5,
    )
}

fn bam(named: &[Suggestion], [before, after]: [f64; 2]) -> Judged {
    let depends_on_load = named.first().is_some_and(|first| {
        ["load_linear", "load_quadratic", "load_viscous", "stribeck_load"].contains(&first.effect.as_str())
    });
    let less = 1.0 - after / before;
    let squared = 1.0 - (after / before).powi(2);
    (
        "friction that depends on the load; validation error −30 %",
        format!("−{:.0} % in RMS, −{:.0} % in squares", 100.0 * less, 100.0 * squared),
        depends_on_load && less >= 0.3,
    )
}

fn odrive(added: &[&str], whole: &Discovery) -> Judged {
    let found = waves(&whole.fit);
    let words: Vec<String> = found.iter().map(f64::to_string).collect();
    (
        "cogging, with 7, 12, 14 and 36 waves a turn",
        format!("{} waves", words::list(&words)),
        added.first() == Some(&"cogging") && WAVES.iter().all(|known| found.contains(known)),
    )
}

fn placid(named: &[Suggestion], whole: &Discovery) -> Judged {
    let is_hidden = whole.not_visible.iter().any(|hidden| hidden.effect == "hysteresis");
    (
        "saturation; hysteresis not visible in one branch",
        format!("hysteresis {}", if is_hidden { "not visible" } else { "taken for visible" }),
        is_hidden && named.first().is_some_and(|first| first.effect == "saturation"),
    )
}
