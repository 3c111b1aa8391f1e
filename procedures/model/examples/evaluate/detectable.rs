//! Power of the detection limit: an effect of that size is added to a run of the same machine with other noise, and
//! the rate of its detection is measured.

use crate::made::Dice;
use crate::options::Asked;
use crate::power::{EFFECTS, Rms, run};
use crate::score::Count;
use jointbench_model::{ModelSpec, Options, diagnose};
use std::error::Error;

pub fn measure(asked: &Asked) -> Result<(), Box<dyn Error>> {
    println!("\nEffects of the size from which they are said to be found\n\n| effect | named or tied |\n| --- | --- |");
    let mut whole = Count::default();
    for (e, effect) in EFFECTS.iter().enumerate() {
        let mut found = Count::default();
        for i in (asked.first..).take(asked.count as usize / 10) {
            let dice = |number: u64| Dice::new(number + 1000 * e as u64 + i);
            let nothing = run(effect, Rms::Whole(0.0), &mut dice(800_000));
            let silent = diagnose(&nothing, &ModelSpec::baseline(&nothing)?, &Options::default())?.silent;
            let Some(silent) = silent.into_iter().find(|s| s.effect == *effect) else { continue };
            let run = run(effect, Rms::Whole(silent.minimum_detectable_rms), &mut dice(900_000));
            let named = diagnose(&run, &ModelSpec::baseline(&run)?, &Options::default())?.suggestions;
            let is_named = named.iter().any(|s| s.effect == *effect || s.confounded_with.iter().any(|c| c == effect));
            found.add(is_named);
            whole.add(is_named);
        }
        println!("| {effect} | {} |", found.show());
    }
    println!("| all | {} |\n", whole.show());
    Ok(())
}
