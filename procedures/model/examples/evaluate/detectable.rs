//! Power of the detection limit: an effect of that size is added to a run of the same machine with other noise, and
//! the rate of its detection is measured.

use crate::made::Dice;
use crate::options::Asked;
use crate::power::{EFFECTS, Rms, run};
use crate::score::Count;
use jointbench_model::{ModelSpec, Options, diagnose};
use std::error::Error;

pub fn measure(asked: &Asked) -> Result<(), Box<dyn Error>> {
    println!(
        "\nEffects of the size from which they are said to be found (80 %), and of their upper limit (95 %)\n\n| effect | \
         named or tied | at the upper limit |\n| --- | --- | --- |"
    );
    let (mut whole, mut whole_upper) = (Count::default(), Count::default());
    for (e, effect) in EFFECTS.iter().enumerate() {
        let (mut found, mut found_upper) = (Count::default(), Count::default());
        for i in (asked.first..).take(asked.count as usize / 10) {
            let dice = |number: u64| Dice::new(number + 1000 * e as u64 + i);
            let nothing = run(effect, Rms::Whole(0.0), &mut dice(800_000));
            let silent = diagnose(&nothing, &ModelSpec::baseline(&nothing)?, &Options::default())?.bounded().silent;
            let Some(silent) = silent.into_iter().find(|s| s.effect == *effect) else { continue };
            let is_named = |rms: f64| -> Result<bool, Box<dyn Error>> {
                let run = run(effect, Rms::Whole(rms), &mut dice(900_000));
                let named = diagnose(&run, &ModelSpec::baseline(&run)?, &Options::default())?.suggestions;
                Ok(named.iter().any(|s| s.effect == *effect || s.confounded_with.iter().any(|c| c == effect)))
            };
            let (at_limit, at_upper) =
                (is_named(silent.minimum_detectable_rms)?, is_named(silent.upper_rms.unwrap_or_default())?);
            found.add(at_limit);
            whole.add(at_limit);
            found_upper.add(at_upper);
            whole_upper.add(at_upper);
        }
        println!("| {effect} | {} | {} |", found.show(), found_upper.show());
    }
    println!("| all | {} | {} |\n", whole.show(), whole_upper.show());
    Ok(())
}
