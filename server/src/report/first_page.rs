//! First page of the report, which is complete on one sheet of A4: verdict, unit under test, main quantities with
//! intervals, one figure, residual map, error before and after, signatures.

use super::figure::small_svg;
use super::number::with_interval;
use super::pairs::moment;
use super::symbol::printed;
use super::{Report, limits, sign_off};
use crate::view::{Figure, Identified, LimitCheck, Quantity, Shown, spoken};
use jointbench_model::words::{self, Scale};
use maud::{Markup, PreEscaped, html};

/// Quantities that have room on the page. The appendix has all of them.
const MOST_QUANTITIES: usize = 12;
/// Limits that have room.
const MOST_LIMITS: usize = 8;
/// Letters of the summary that have room.
const MOST_LETTERS: usize = 700;

impl Report {
    pub(super) fn first_page(&self, title: &str) -> Markup {
        let result = self.identification.as_ref().map(|found| &found.result);
        html! {
            section.first {
                h1 { (title) " " span.badge { (self.origin()) } }
                (self.subject())
                @if let Some(result) = result { (verdict(result)) }
                @if let (Some(check), Some(result)) = (self.limits(), result) {
                    (limits::limits(check, result, MOST_LIMITS))
                }
                @if let Some(result) = result { (quantities(result, self.most_quantities())) }
                (self.figures_of_first_page(result))
                (self.error_line())
                (sign_off::block(&self.signed()))
            }
        }
    }

    fn limits(&self) -> Option<&LimitCheck> {
        self.identification.as_ref()?.limits.as_ref()
    }

    /// The limits take the room of quantities.
    fn most_quantities(&self) -> usize {
        MOST_QUANTITIES - self.limits().map_or(0, |check| check.limits.len().min(MOST_LIMITS))
    }

    /// Unit, people, time and state as one table of two columns.
    fn subject(&self) -> Markup {
        let summary = &self.run.summary;
        let signed = self.signed();
        let line = summary.unit.as_ref().map(crate::view::Unit::line);
        let file = self.file().map(str::to_owned);
        let safe = summary.safe.map(|safe| format!(", bench {}", spoken(safe))).unwrap_or_default();
        let facts = [
            ("Unit under test", line),
            ("Operator", signed.operator.map(str::to_owned)),
            ("Procedure", Some(summary.procedure_title().to_owned())),
            ("Measured", Some(moment(&summary.created_at))),
            ("End state", Some(format!("{}{safe}", summary.state))),
            ("Data of the file", file),
        ];
        html! {
            dl.subject {
                @for (name, value) in facts {
                    @if let Some(value) = value { div { dt { (name) } dd { (value) } } }
                }
            }
            @if let Some(reason) = &summary.reason { p { (reason) } }
        }
    }

    /// The first figure of the result, and the residual map.
    fn figures_of_first_page(&self, result: Option<&Shown>) -> Markup {
        let of_result = result.and_then(|result| result.figures.first());
        let of_residual = self.residual_map.as_ref().and_then(|map| map.figure.as_ref());
        let drawn = |one: &Figure| Some((one.title.clone(), small_svg(one)?));
        html! {
            div.side-by-side {
                @for (title, svg) in [of_result, of_residual].into_iter().flatten().filter_map(drawn) {
                    figure { figcaption { (title) } (PreEscaped(svg)) }
                }
            }
        }
    }

    /// Validation error of the initial and the selected model.
    fn error_line(&self) -> Markup {
        let (Some(first), Some(last)) = (self.versions.first(), self.versions.last()) else { return html! {} };
        let scale = Scale::of(first.validation_rms, &last.fit.unit);
        html! {
            p {
                b { "Model error (validation, RMS): " }
                @if first.id != last.id {
                    (scale.figure(first.validation_rms)) " before, " (scale.figure(last.validation_rms)) " after ("
                    (super::model::change_of(first.validation_rms, last.validation_rms)) ")"
                } @else { (scale.figure(last.validation_rms)) }
                @if let Some(floor) = last.noise_floor_rms { "; noise floor " (scale.figure(floor)) }
                ". Model: " (self.named(&last.effects)) "."
            }
        }
    }
}

fn verdict(result: &Shown) -> Markup {
    html! {
        p.verdict { strong { (word_of(result)) ". " } (shortened(&result.summary)) }
        @for warning in &result.warnings { p { strong { "Warning. " } (words::signed(warning)) } }
    }
}

/// The verdict in words.
pub(super) fn word_of(result: &Shown) -> &'static str {
    match result.verdict {
        Identified::Identified => "Identified",
        Identified::IdentifiedWithWarning => "Identified with a warning",
        Identified::Inconclusive => "Inconclusive",
        Identified::Failed => "Failed",
    }
}

/// The whole lines, or else the letters, that have room.
fn shortened(summary: &str) -> String {
    let mut letters = 0;
    let has_room = |line: &&str| {
        letters += line.chars().count();
        letters <= MOST_LETTERS
    };
    let lines: Vec<&str> = summary.lines().take_while(has_room).collect();
    match lines.is_empty() {
        true if !summary.is_empty() => summary.chars().take(MOST_LETTERS).chain(['…']).collect(),
        _ => lines.join("\n"),
    }
}

/// Quantities with an interval first, because they are the results.
fn quantities(result: &Shown, most: usize) -> Markup {
    let (certain, others): (Vec<&Quantity>, Vec<&Quantity>) =
        result.quantities.iter().partition(|quantity| quantity.ci95.is_some());
    let all: Vec<&Quantity> = certain.into_iter().chain(others).collect();
    let shown = &all[..all.len().min(most)];
    html! {
        @if !shown.is_empty() {
            table {
                tr { th { "Quantity" } th { "Symbol" } th.figure { "Value" } th.figure { "95 % interval" } }
                @for quantity in shown {
                    @let (value, interval) = with_interval(quantity.value, quantity.ci95, &quantity.unit);
                    tr {
                        td { (quantity.title) } td { (printed(&quantity.symbol)) }
                        td.figure { (value) } td.figure { (interval.unwrap_or_else(|| "–".to_owned())) }
                    }
                }
            }
            @if all.len() > shown.len() { p.quiet { "All " (all.len()) " quantities: appendix." } }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{MOST_LETTERS, shortened};

    #[test]
    fn a_summary_ends_at_a_line_that_has_room() {
        let line = "x".repeat(MOST_LETTERS / 2);
        assert_eq!(shortened(&format!("{line}\n{line}\n{line}")), format!("{line}\n{line}"));
        assert_eq!(shortened(&"x".repeat(2 * MOST_LETTERS)).chars().count(), MOST_LETTERS + 1);
        assert_eq!(shortened(""), "");
    }
}
