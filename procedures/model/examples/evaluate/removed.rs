//! One effect removed from a complete model, as by a user in the workbench: the diagnosis has to name it.

use crate::made;
use crate::options::Asked;
use crate::score::Count;
use jointbench_model::{ModelSpec, Options, diagnose, fit};
use std::error::Error;

/// An effect is missed if its removal increases the error by this share.
const MISSED: f64 = 0.1;

/// Removes each effect of the complete models of all cases, one at a time.
pub fn measure(asked: &Asked) -> Result<(), Box<dyn Error>> {
    let (mut first, mut exact) = (Count::default(), Count::default());
    let rounds = (asked.first..).take(asked.rounds as usize).flat_map(made::round);
    let complete = |case: &made::Case| !case.answer.unknown && asked.takes(case.family, &case.name);
    for case in rounds.filter(complete) {
        let hidden = case.answer.accept.iter().filter_map(|group| group.first());
        let effects: Vec<String> = ModelSpec::baseline(&case.run)?.effects.into_iter().chain(hidden.cloned()).collect();
        let of = |effects: &[String]| ModelSpec::new(case.run.kind(), effects.to_vec());
        let least = fit(&case.run, &of(&effects)?, &Options::default())?.validation_rms;
        for removed in &effects {
            let rest: Vec<String> = effects.iter().filter(|e| *e != removed).cloned().collect();
            let Ok(found) = of(&rest).and_then(|rest| diagnose(&case.run, &rest, &Options::default())) else {
                continue;
            };
            if found.fit.validation_rms < (1.0 + MISSED) * least {
                continue;
            }
            let is_first =
                |s: &jointbench_model::Suggestion| s.effect == *removed || s.confounded_with.contains(removed);
            let is_right = first.add(found.suggestions.first().is_some_and(is_first));
            let is_all = exact.add(is_right && found.suggestions.len() == 1);
            if !asked.quiet && !is_all {
                let named: Vec<&str> = found.suggestions.iter().map(|s| s.effect.as_str()).collect();
                println!("{:44} without {removed:24} {}: {}", case.name, named.join(","), found.summary);
            }
        }
    }
    println!(
        "One effect taken out of a complete model: named first {}, and nothing else {}\n",
        first.show(),
        exact.show()
    );
    Ok(())
}
