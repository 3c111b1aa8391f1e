//! The result of a diagnosis as one HTML page without references to other files.

mod next;
mod svg;

use crate::diagnose::{EffectShare, FleetDiagnosis, GroupShare, share};
use crate::fit::{FleetFit, PartFit, PartParameter, named, omitted};
use jointbench_model::words::{Scale, figure, percent};
use std::fmt::Write as _;
use svg::{Interval, escaped, histogram, intervals};

const STYLE: &str = include_str!("style.css");
/// Listed units of one effect and outliers of one parameter; all are in the JSON.
const LISTED: usize = 50;

/// The page: shares of the units for each missing effect by batch and week, distributions of the parameters, outliers,
/// and what to measure next.
pub fn page(found: &FleetDiagnosis) -> String {
    let model = escaped(&found.model.join(" + "));
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>Fleet report</title><style>{STYLE}</style></head>\n<body>\n<h1>Fleet report</h1>\n\
         <p>Model: {model}. {} units are tested. At most {} of the named units are expected to be wrong. \
         Intervals are 95 %.</p>\n",
        found.tested,
        percent(found.false_discovery_rate)
    );
    html += &missing(found);
    html += "<h2>Parameters</h2>\n";
    found.fit.parts.iter().for_each(|part| html += &of_part(&found.fit, part));
    html += &next::section(found);
    let omitted = escaped(&omitted(&found.fit.omitted)).replace('\n', "<br>");
    if !omitted.is_empty() {
        let _ = writeln!(html, "<h2>Omitted runs</h2>\n<p>{omitted}</p>");
    }
    html + "</body>\n</html>\n"
}

fn missing(found: &FleetDiagnosis) -> String {
    let mut html = "<h2>Missing effects</h2>\n".to_owned();
    if found.effects.is_empty() {
        html += "<p>No missing effect was found in any unit.</p>\n";
    }
    found.effects.iter().for_each(|effect| html += &of_effect(effect));
    html
}

fn of_effect(effect: &EffectShare) -> String {
    let name = escaped(&effect.effect);
    let mut html = format!("<h3>{name}</h3>\n<p>{} of the units</p>\n", escaped(&share(&effect.share)));
    let row = |group: &GroupShare, what: &str| Interval {
        label: format!("{} ({})", named(what, &group.group), group.share.of),
        value: 100.0 * group.share.share,
        ends: group.share.ci95.map(|end| 100.0 * end),
        // Another batch or week than the rest: its interval excludes the share of all units.
        is_marked: group.share.ci95[0] > effect.share.share || group.share.ci95[1] < effect.share.share,
    };
    let number = |value: f64| format!("{value:.1}");
    for (title, what, groups) in [("by batch", "batch", &effect.batches), ("by week", "", &effect.weeks)] {
        let rows: Vec<Interval> = groups.iter().map(|group| row(group, what)).collect();
        let title = format!("{}: units with the effect {title} (number of units)", effect.effect);
        html += &intervals(&title, "units with the effect [%]", &rows, Some(0.0), number);
    }
    html += "<table><tr><th>serial number</th><th>part</th><th>batch</th><th>bench</th><th class=\"figure\">p-value</th>\
             <th class=\"figure\">reduction of the validation error</th><th>confounded with</th></tr>\n";
    for found in effect.units.iter().take(LISTED) {
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"figure\">{:.1e}</td><td class=\"figure\">{}</td>\
             <td>{}</td></tr>",
            escaped(&found.unit.serial),
            escaped(&found.unit.part),
            escaped(&found.unit.batch),
            escaped(&found.unit.bench),
            found.p_value,
            percent(found.error_reduction),
            escaped(&found.confounded_with.join(", "))
        );
    }
    html + "</table>\n" + &more(effect.units.len())
}

fn more(count: usize) -> String {
    let rest = count.saturating_sub(LISTED);
    if rest > 0 { format!("<p class=\"quiet\">{rest} more: see --json.</p>\n") } else { String::new() }
}

fn of_part(fit: &FleetFit, part: &PartFit) -> String {
    let mut html = format!("<h3>{}: {} units</h3>\n", escaped(&named("part", &part.part)), part.units);
    part.parameters.iter().for_each(|parameter| html += &of_parameter(fit, part, parameter));
    html
}

fn of_parameter(fit: &FleetFit, part: &PartFit, parameter: &PartParameter) -> String {
    let PartParameter { effect, name, unit, population, batches, outliers } = parameter;
    let title = format!("{effect}.{name}");
    let is_meant = |p: &&crate::fit::UnitParameter| p.effect == *effect && p.name == *name && p.unit == *unit;
    let of_part = fit.units.iter().filter(|fit| fit.unit.part == part.part);
    let values: Vec<f64> = of_part.filter_map(|fit| Some(fit.parameters.iter().find(is_meant)?.value)).collect();
    let largest = values.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    let scale = Scale::of(largest, unit);
    let label = match scale.unit() {
        "" => title.clone(),
        unit => format!("{title} [{unit}]"),
    };
    let number = |value: f64| scale.number(value);
    let mut html = histogram(&format!("{title}: units"), &label, &values, number);
    if let Some(p) = population {
        let [low, high] = p.ci95.map(|end| figure(end, unit));
        let _ = writeln!(
            html,
            "<p>Mean {} [{low}, {high}]. Standard deviation between units {}.</p>",
            figure(p.mean, unit),
            figure(p.between_sd, unit)
        );
    }
    let row = |batch: &crate::fit::BatchFit| Interval {
        label: format!("{} ({})", named("batch", &batch.batch), batch.population.units),
        value: batch.population.mean,
        ends: batch.population.ci95,
        is_marked: batch.is_shifted,
    };
    let rows: Vec<Interval> = batches.iter().map(row).collect();
    html += &intervals(&format!("{title}: mean of each batch (number of units)"), &label, &rows, None, number);
    for batch in batches.iter().filter(|batch| batch.is_shifted) {
        let [low, high] = batch.difference_ci95.map(|end| figure(end, unit));
        let _ = writeln!(
            html,
            "<p>{} differs by {} [{low}, {high}] from the median batch.</p>",
            escaped(&named("Batch", &batch.batch)),
            figure(batch.difference, unit)
        );
    }
    if !outliers.is_empty() {
        html += "<table><tr><th>outlier</th><th>batch</th><th class=\"figure\">value</th>\
                 <th class=\"figure\">deviation [SD]</th></tr>\n";
        for outlier in outliers.iter().take(LISTED) {
            let _ = writeln!(
                html,
                "<tr><td>{}</td><td>{}</td><td class=\"figure\">{}</td><td class=\"figure\">{:+.1}</td></tr>",
                escaped(&outlier.serial),
                escaped(&outlier.batch),
                figure(outlier.value, unit),
                outlier.deviation
            );
        }
        html += "</table>\n";
        html += &more(outliers.len());
    }
    html
}
