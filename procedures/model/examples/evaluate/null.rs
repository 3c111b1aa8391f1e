//! Runs without hidden effects: the rate of named effects.

use crate::made;
use crate::options::Asked;
use jointbench_model::{ModelSpec, Options, Verdict, diagnose};
use statrs::distribution::{Beta, ContinuousCDF};
use std::error::Error;

pub fn measure(asked: &Asked) -> Result<(), Box<dyn Error>> {
    let (mut runs, mut named, mut structure, mut false_names) = (0usize, 0usize, 0usize, 0usize);
    for case in (asked.first..).take(asked.count as usize).map(made::null).filter(|c| asked.takes(c.family, &c.name)) {
        let found = diagnose(&case.run, &ModelSpec::baseline(&case.run)?, &Options::default())?;
        runs += 1;
        named += usize::from(!found.suggestions.is_empty());
        false_names += found.suggestions.len();
        structure += usize::from(found.verdict == Verdict::UnexplainedStructure);
        if found.verdict != Verdict::Adequate && !asked.quiet {
            println!("{}: {}", case.name, found.summary);
        }
    }
    println!(
        "\nNothing hidden\n\n| runs | name an effect | upper 95 % bound | effects named | call it unexplained structure |\n\
         | --- | --- | --- | --- | --- |\n| {runs} | {:.1} % ({named}) | {:.1} % | {false_names} | {structure} |\n",
        100.0 * named as f64 / runs.max(1) as f64,
        100.0 * upper_bound(named, runs),
    );
    Ok(())
}

/// One-sided 95 % bound on a share, Clopper and Pearson 1934.
fn upper_bound(hits: usize, of: usize) -> f64 {
    if hits >= of {
        return 1.0;
    }
    Beta::new((hits + 1) as f64, (of - hits) as f64).map_or(1.0, |b| b.inverse_cdf(0.95))
}
