//! Result of the run's procedure.

use super::figure::svg;
use super::first_page::word_of;
use super::limits::limits;
use super::number::with_interval;
use super::symbol::printed;
use crate::view::{Identification, command};
use jointbench_model::words;
use maud::{Markup, PreEscaped, html};

/// Verdict, quantities and figures of the procedure.
pub fn result(found: &Identification) -> Markup {
    let result = &found.result;
    let verdict = word_of(result);
    html! {
        h2 { "Result" }
        p.verdict { strong { (verdict) ". " } (result.summary) }
        @for warning in &result.warnings { p.verdict { strong { "Warning. " } (words::signed(warning)) } }
        @if let Some(advice) = &result.advice { p.verdict { "Next: " (advice) } }
        @if !result.quantities.is_empty() {
            table {
                tr { th { "Quantity" } th { "Symbol" } th.figure { "Value" } th.figure { "95 % interval" } th { "Name" } }
                @for quantity in &result.quantities {
                    @let (value, interval) = with_interval(quantity.value, quantity.ci95, &quantity.unit);
                    tr {
                        td { (quantity.title) } td { (printed(&quantity.symbol)) }
                        td.figure { (value) } td.figure { (interval.unwrap_or_else(|| "–".to_owned())) }
                        td.quiet { code { (quantity.name) } }
                    }
                }
            }
        }
        @if let Some(check) = &found.limits { (limits(check, result, check.limits.len())) }
        @if let Some(next) = &found.follow_up {
            p {
                "Next: " (next.why) ": " code { (command(&next.procedure, &next.parameters)) }
            }
        }
        @for one in &result.figures {
            @if let Some(svg) = svg(one) {
                figure { figcaption { (one.title) } (PreEscaped(svg)) }
            }
        }
        p.quiet { "Computed by " (found.software) "." }
    }
}
