//! The fit of a fleet in words.

use super::{FleetFit, PartFit, PartParameter};
use crate::units::Omitted;
use jointbench_model::words::{figure, list};
use std::fmt::Write as _;

/// Listed outliers of one parameter; all are in the JSON.
const LISTED: usize = 10;

/// Populations, shifted batches and outliers of each part, one line each.
pub fn text(fit: &FleetFit) -> String {
    format!("Model: {}\n", fit.model.join(" + ")) + &populations(fit) + &omitted(&fit.omitted)
}

/// The populations of all parts, and the units without a fit.
pub(crate) fn populations(fit: &FleetFit) -> String {
    let mut text: String = fit.parts.iter().map(of_part).collect();
    if let Some(first) = fit.refused.first() {
        let _ = writeln!(
            text,
            "Not fitted: {} units, for example {}: {}",
            fit.refused.len(),
            first.unit.serial,
            first.reason
        );
    }
    text
}

/// A part or batch by its name.
pub(crate) fn named(what: &str, name: &str) -> String {
    if name.is_empty() { format!("no {what}") } else { format!("{what} {name}") }
}

fn of_part(part: &PartFit) -> String {
    let mut text = format!("\n{}: {} units\n", named("part", &part.part), part.units);
    part.parameters.iter().for_each(|parameter| text += &of_parameter(parameter));
    text
}

fn of_parameter(parameter: &PartParameter) -> String {
    let PartParameter { effect, name, unit, population, batches, outliers } = parameter;
    let mut text = format!("  {effect}.{name}");
    let value = |value: f64| figure(value, unit);
    match population {
        Some(p) => {
            let [low, high] = p.ci95.map(value);
            let _ =
                writeln!(text, ": mean {} [{low}, {high}], SD between units {}", value(p.mean), value(p.between_sd));
        }
        None => text += ": one unit\n",
    }
    for batch in batches.iter().filter(|batch| batch.is_shifted) {
        let [low, high] = batch.difference_ci95.map(value);
        let _ = writeln!(
            text,
            "    {} differs by {} [{low}, {high}] from the median batch (p = {:.1e})",
            named("batch", &batch.batch),
            value(batch.difference),
            batch.p_value
        );
    }
    if !outliers.is_empty() {
        let mut sorted: Vec<_> = outliers.iter().collect();
        sorted.sort_by(|a, b| b.deviation.abs().total_cmp(&a.deviation.abs()));
        let first: Vec<String> =
            sorted.iter().take(LISTED).map(|o| format!("{} ({})", o.serial, value(o.value))).collect();
        let _ = writeln!(text, "    {} outliers, the largest: {}", outliers.len(), list(&first));
    }
    text
}

/// Runs that represent no unit, one line each; empty if there are none.
pub(crate) fn omitted(omitted: &Omitted) -> String {
    let counts = [
        (omitted.without_serial, "without a serial number"),
        (omitted.not_completed, "not completed"),
        (omitted.other_kind, "of another kind than friction"),
        (omitted.earlier_runs, "earlier runs of a unit"),
        (omitted.duplicates, "in the archive a second time"),
        (omitted.damaged.len(), "files damaged and omitted"),
    ];
    let line = |(count, what): &(usize, &str)| format!("Omitted: {count} {what}\n");
    counts.iter().filter(|(count, _)| *count > 0).map(line).collect()
}
