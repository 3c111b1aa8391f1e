//! The diagnosis of a fleet in words.

use super::{EffectShare, FleetDiagnosis};
use crate::fit::{named, omitted, populations};
use crate::statistics::proportion::Share;
use jointbench_model::words::{figure, percent};
use std::fmt::Write as _;

/// Listed units of one effect, and listed effects without a decision; all are in the JSON.
const LISTED: usize = 10;

/// Missing effects with their shares, populations of the parameters, and what the runs cannot show.
pub fn text(found: &FleetDiagnosis) -> String {
    let mut text = format!("Model: {}\n", found.model.join(" + "));
    let rate = percent(found.false_discovery_rate);
    let _ = writeln!(text, "Tested: {} units, false discovery rate {rate}", found.tested);
    if found.effects.is_empty() {
        text += "No missing effect was found in any unit.\n";
    }
    found.effects.iter().for_each(|effect| text += &of_effect(effect));
    if found.unexplained.share.count > 0 {
        let chance = if found.unexplained.is_significant { "more than" } else { "no more than" };
        let _ = writeln!(
            text,
            "\nStructure that no effect explains: {}, {chance} the error probability of the test",
            share(&found.unexplained.share)
        );
    }
    text += &populations(&found.fit);
    text += "\n";
    for undecided in &found.undecided {
        let _ = writeln!(text, "Undecided: {} units, for example: {}", undecided.units, undecided.example);
    }
    for effect in found.not_testable.iter().take(LISTED) {
        let _ = writeln!(text, "Not testable in {} units: {} ({})", effect.units, effect.effect, effect.reason);
    }
    for limit in found.detection_limits.iter().take(LISTED) {
        let rms = figure(limit.median_rms, &limit.unit);
        let _ = writeln!(
            text,
            "Detection limit (RMS, 80 % power, median of {} units): {} {rms}",
            limit.units, limit.effect
        );
    }
    text + &omitted(&found.fit.omitted)
}

/// `3.1 % [2.4 %, 4.0 %] (62 of 2000)`
pub(crate) fn share(share: &Share) -> String {
    let [low, high] = share.ci95.map(percent);
    format!("{} [{low}, {high}] ({} of {})", percent(share.share), share.count, share.of)
}

fn of_effect(effect: &EffectShare) -> String {
    let mut text = format!("\nMissing effect: {} in {}\n", effect.effect, share(&effect.share));
    for batch in effect.batches.iter().filter(|batch| batch.share.count > 0) {
        let (part, name) = (named("part", &batch.part), named("batch", &batch.group));
        let _ = writeln!(text, "  {part}, {name}: {}", share(&batch.share));
    }
    let serials: Vec<&str> = effect.units.iter().take(LISTED).map(|found| found.unit.serial.as_str()).collect();
    let rest = if effect.units.len() > LISTED { ", …" } else { "" };
    let _ = writeln!(text, "  units: {}{rest}", serials.join(", "));
    text
}
