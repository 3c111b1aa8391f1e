//! One run without an answer: its findings, step by step.

use crate::common;
use jointbench_model::{ModelSpec, Options, diagnose, discover};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

pub fn show(folder: &Path) -> Result<(), Box<dyn Error>> {
    let run = common::read(folder);
    let spec = ModelSpec::baseline(&run)?;
    let start = Instant::now();
    let first = diagnose(&run, &spec, &Options::default())?;
    println!("{} ({:.3} s)", first.summary, start.elapsed().as_secs_f64());
    for s in &first.suggestions {
        let gain = -100.0 * s.error_reduction;
        println!("  {} {gain:+.1} % p {:.3}, tied with {:?}", s.effect, s.p_value, s.confounded_with);
    }
    first.regions.iter().take(3).for_each(|r| println!("  {}", r.sentence));
    first.not_visible.iter().for_each(|n| println!("  not visible: {} ({})", n.effect, n.why));
    let whole = discover(&run, &spec, &Options::default(), 6)?;
    for s in &whole.steps {
        let made = match (&s.added, &s.removed) {
            (Some(added), _) => format!("+ {added}"),
            (None, Some(removed)) => format!("− {removed}"),
            (None, None) => "start".into(),
        };
        println!("  {made:24} rms {:.4e} held out {:.4e}", s.rms, s.validation_rms);
    }
    for p in &whole.fit.parameters {
        println!("  {}.{} = {:.5} {} [{:.5}, {:.5}]", p.effect, p.name, p.value, p.unit, p.ci95[0], p.ci95[1]);
    }
    println!("  relative error {:.3} %; {}", 100.0 * whole.fit.relative_error, whole.summary);
    Ok(())
}
