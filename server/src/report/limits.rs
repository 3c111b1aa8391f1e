//! The limits of the run as a table.

use super::number::with_interval;
use crate::view::{LimitCheck, LimitOutcome, LimitResult, Shown};
use maud::{Markup, html};
use std::cmp::Reverse;

/// The `most` worst limits, with the measured values.
pub fn limits(check: &LimitCheck, result: &Shown, most: usize) -> Markup {
    let mut sorted: Vec<&LimitResult> = check.limits.iter().collect();
    sorted.sort_by_key(|limit| Reverse(limit.outcome));
    html! {
        p.verdict { strong { "Limits: " (word_of(check.outcome)) ". " } (count(check)) }
        table {
            tr { th { "Limit" } th.figure { "Value" } th.figure { "95 % interval" } th { "Outcome" } }
            @for limit in sorted.iter().take(most) {
                @let (value, interval) = measured(limit, result);
                tr { td { (limit.text) } td.figure { (value) } td.figure { (interval) } td { (word_of(limit.outcome)) } }
                @if let Some(decision) = &limit.decision { tr { td.quiet colspan="4" { (decision.to_string()) } } }
            }
        }
        @if sorted.len() > most { p.quiet { "All " (sorted.len()) " limits: appendix." } }
    }
}

pub(super) fn word_of(outcome: LimitOutcome) -> &'static str {
    match outcome {
        LimitOutcome::Pass => "pass",
        LimitOutcome::Marginal => "marginal",
        LimitOutcome::Inconclusive => "inconclusive",
        LimitOutcome::Fail => "fail",
    }
}

fn count(check: &LimitCheck) -> String {
    let passed = check.limits.iter().filter(|limit| limit.outcome == LimitOutcome::Pass).count();
    format!("{passed} of {} within their limits.", check.limits.len())
}

fn measured(limit: &LimitResult, result: &Shown) -> (String, String) {
    let quantity = result.quantities.iter().find(|quantity| quantity.name == limit.quantity);
    let shown = quantity.map(|quantity| with_interval(quantity.value, quantity.ci95, &quantity.unit));
    let none = || "–".to_owned();
    shown.map_or_else(|| (none(), none()), |(value, interval)| (value, interval.unwrap_or_else(none)))
}
