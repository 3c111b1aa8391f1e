//! What to measure next: what the runs of many units cannot show.

use super::svg::escaped;
use crate::diagnose::{FleetDiagnosis, share};
use jointbench_model::words::figure;
use std::fmt::Write as _;

/// Units that need another run, effects that the runs cannot show, and detection limits.
pub fn section(found: &FleetDiagnosis) -> String {
    let mut html = "<h2>What to measure next</h2>\n".to_owned();
    if found.unexplained.is_significant {
        let serials: Vec<String> = found.unexplained.units.iter().map(|unit| escaped(&unit.serial)).collect();
        let _ = writeln!(
            html,
            "<p>No effect of the library explains the structure of {} of the units. Diagnose their samples one by one: {}.</p>",
            escaped(&share(&found.unexplained.share)),
            serials.join(", ")
        );
    }
    if !found.undecided.is_empty() || !found.not_testable.is_empty() {
        html += "<table><tr><th>question</th><th class=\"figure\">units</th><th>reason</th></tr>\n";
        for undecided in &found.undecided {
            let _ = writeln!(
                html,
                "<tr><td>Is the model adequate?</td><td class=\"figure\">{}</td><td>{}</td></tr>",
                undecided.units,
                escaped(&undecided.example)
            );
        }
        for effect in &found.not_testable {
            let _ = writeln!(
                html,
                "<tr><td>Is {} missing?</td><td class=\"figure\">{}</td><td>{}</td></tr>",
                escaped(&effect.effect),
                effect.units,
                escaped(&effect.reason)
            );
        }
        html += "</table>\n";
    }
    if !found.detection_limits.is_empty() {
        html += "<p>Detection limits (RMS, 80 % power) of effects that were not found, median over the units. A smaller \
                 effect needs more operating points or more repeats.</p>\n<table><tr><th>effect</th>\
                 <th class=\"figure\">detection limit</th><th class=\"figure\">units</th></tr>\n";
        for limit in &found.detection_limits {
            let _ = writeln!(
                html,
                "<tr><td>{}</td><td class=\"figure\">{}</td><td class=\"figure\">{}</td></tr>",
                escaped(&limit.effect),
                figure(limit.median_rms, &limit.unit),
                limit.units
            );
        }
        html += "</table>\n";
    }
    html
}
