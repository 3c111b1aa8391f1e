//! The model of a run: validation error before and after, residual map, parameters, diagnosis.

use super::Report;
use super::figure::svg;
use super::heat_map::heat_map;
use super::number::with_interval;
use super::symbol::printed;
use crate::view::{Diagnosis, Model, ParameterState, Suggestion, Verdict};
use jointbench_model::words::{self, Scale};
use maud::{Markup, PreEscaped, html};
use std::collections::BTreeSet;

/// Suggestions and regions that a report lists.
const MOST_LISTED: usize = 5;

/// One row of the table of errors.
struct ErrorRow {
    version: String,
    change: String,
    rms: f64,
}

impl Report {
    pub(super) fn model(&self, model: &Model) -> Markup {
        html! {
            h2 { "Model" }
            p { (self.named(&model.effects)) }
            (self.before_and_after(model))
            (self.residuals())
            (self.parameters(model))
            @if let Some(diagnosis) = &self.diagnosis { (self.diagnosed(diagnosis)) }
        }
    }

    /// Validation error of each version, and of each suggested effect alone.
    fn before_and_after(&self, model: &Model) -> Markup {
        let baseline = self.versions.first().map_or(model.validation_rms, |first| first.validation_rms);
        let scale = Scale::of(baseline, &model.fit.unit);
        let of_version = |version: &Model| ErrorRow {
            version: version.id.to_string(),
            change: self.change(version),
            rms: version.validation_rms,
        };
        let of_suggestion = |suggestion: &Suggestion| ErrorRow {
            version: "suggested".to_owned(),
            change: format!("+ {} alone", self.titled(&suggestion.effect)),
            rms: suggestion.validation_rms,
        };
        let rows: Vec<ErrorRow> =
            self.versions.iter().map(of_version).chain(self.suggestions().map(of_suggestion)).collect();
        let most = rows.iter().map(|row| row.rms).fold(f64::MIN_POSITIVE, f64::max);
        html! {
            section.whole {
                h3 { "Validation error before and after" }
                @if self.versions.len() > 1 {
                    p.verdict {
                        "Validation error of the initial model: " (scale.figure(baseline)) ". Of the selected model: "
                        (scale.figure(model.validation_rms)) " (" (change_of(baseline, model.validation_rms)) ")."
                        @if let Some(floor) = model.noise_floor_rms { " Noise floor: " (scale.figure(floor)) "." }
                    }
                }
                table.errors {
                    tr { th { "Version" } th { "Change" } th.figure { "Validation error" } th.figure { "Relative to initial" } td { } }
                    @for (place, row) in rows.iter().enumerate() {
                        tr {
                            td { (row.version) }
                            td { (row.change) }
                            td.figure { (scale.figure(row.rms)) }
                            td.figure { @if place > 0 { (change_of(baseline, row.rms)) } }
                            td width="35%" { (bar(row.rms / most)) }
                        }
                    }
                    @if let Some(floor) = model.noise_floor_rms {
                        tr {
                            td { } td { "noise floor (repeatability)" } td.figure { (scale.figure(floor)) } td { }
                            td { (bar(floor / most)) }
                        }
                    }
                }
            }
        }
    }

    fn residuals(&self) -> Markup {
        let Some(map) = &self.residual_map else { return html! {} };
        html! {
            @if let Some((title, svg)) = map.figure.as_ref().and_then(|one| Some((&one.title, svg(one)?))) {
                figure {
                    figcaption { (title) }
                    (PreEscaped(svg))
                    p.quiet { "Mean of measured − model in each bin. The 95 % bands are simultaneous over all bins of all axes." }
                }
            }
            @if let Some(why) = &map.why_not { p.quiet { "No residual map: " (self.sentence(why)) } }
        }
    }

    fn parameters(&self, model: &Model) -> Markup {
        html! {
            h3 { "Parameters" }
            table {
                tr { th { "Effect" } th { "Parameter" } th.figure { "Value" } th.figure { "95 % interval" } td { } }
                @for parameter in &model.fit.parameters {
                    @let ends = Some(parameter.ci95).filter(|ends| ends.iter().all(|end| end.is_finite()));
                    @let is_fixed = parameter.state == ParameterState::Fixed;
                    @let (value, interval) = with_interval(parameter.value, ends.filter(|_| !is_fixed), &parameter.unit);
                    tr {
                        td { (self.titled(&parameter.effect)) } td { (printed(&self.symbol(&parameter.effect, &parameter.name))) }
                        td.figure { (value) } td.figure { @if is_fixed { "fixed" } @else { (interval.unwrap_or_default()) } }
                        td { @if parameter.state != ParameterState::Ok { (parameter.note.clone().unwrap_or_default()) } }
                    }
                }
            }
            @for pair in &model.fit.trade_offs {
                @let correlation = words::with_minus(&format!("{:.2}", pair.correlation));
                p.quiet {
                    "Parameter trade-off: " (self.parameter(&pair.first)) " and " (self.parameter(&pair.second))
                    " (correlation " (correlation) ")."
                }
            }
            @for note in &model.fit.notes { p.quiet { (self.sentence(note)) } }
        }
    }

    /// Titles of effects as a sum.
    pub(super) fn named(&self, effects: &[String]) -> String {
        effects.iter().map(|id| self.titled(id)).collect::<Vec<_>>().join(" + ")
    }

    pub(super) fn titled<'s>(&'s self, effect: &'s str) -> &'s str {
        self.effects.get(effect).map_or(effect, |known| known.title.as_str())
    }

    /// A parameter of a trade-off: `coulomb.tau_c` becomes Coulomb friction τ_c.
    fn parameter(&self, id: &str) -> Markup {
        let (effect, name) = id.split_once('.').unwrap_or(("", id));
        html! { (self.titled(effect)) " " (printed(&self.symbol(effect, name))) }
    }

    fn symbol(&self, effect: &str, name: &str) -> String {
        self.effects.get(effect).map_or_else(|| name.to_owned(), |effect| effect.symbol(name))
    }

    pub(super) fn sentence(&self, text: &str) -> String {
        sentence(text, |id| self.effects.get(id).map(|effect| effect.title.as_str()))
    }

    fn change(&self, version: &Model) -> String {
        match version.parent {
            None => "initial model".to_owned(),
            Some(_) => {
                let added = version.added.iter().map(|id| format!("+ {}", self.titled(id)));
                let removed = version.removed.iter().map(|id| format!("− {}", self.titled(id)));
                let reasons: BTreeSet<&str> = version.excluded.iter().map(|one| one.reason.as_str()).collect();
                let without = reasons.into_iter().map(|reason| format!("without samples: {reason}"));
                added.chain(removed).chain(without).collect::<Vec<_>>().join(", ")
            }
        }
    }

    /// Effects that the diagnosis suggests. A diagnosis with data problems is no basis for advice.
    fn suggestions(&self) -> impl Iterator<Item = &Suggestion> {
        let found = self.diagnosis.iter().map(|diagnosis| &diagnosis.finding);
        let found = found.filter(|found| found.undecided.is_none() || found.verdict == Verdict::Adequate);
        found.flat_map(|found| found.suggestions.iter().take(MOST_LISTED))
    }

    fn diagnosed(&self, diagnosis: &Diagnosis) -> Markup {
        let found = &diagnosis.finding;
        let verdict = match (found.verdict, &found.undecided) {
            (Verdict::Adequate, Some(_)) => "Undecided",
            (_, Some(_)) => "Data problem",
            (Verdict::Adequate, None) => "Adequate",
            (Verdict::MissingEffect, None) => "An effect is missing",
            (Verdict::UnexplainedStructure, None) => "Unexplained structure",
        };
        let is_advice = found.undecided.is_none() || found.verdict == Verdict::Adequate;
        html! {
            h2 { "Diagnosis" }
            p.verdict { strong { (verdict) ". " } (self.sentence(&found.summary)) }
            @if !found.regions.is_empty() {
                p { "Regions with significant residual:" }
                ul { @for region in found.regions.iter().take(MOST_LISTED) { li { (self.sentence(&region.sentence)) } } }
            }
            @if let Some((map, shown)) = found.structure.as_ref().zip(self.versions.last()) { (heat_map(map, &shown.fit.unit)) }
            @if self.suggestions().next().is_some() {
                p { "Missing effects:" }
                ul { @for suggestion in self.suggestions() { li { strong { (self.titled(&suggestion.effect)) } ": " (self.sentence(&suggestion.why)) } } }
            }
            @if let Some(experiment) = found.experiment.as_ref().filter(|_| is_advice) { p { "Recommended next run: " (self.sentence(&experiment.why)) } }
        }
    }
}

/// A sentence with the titles of effects in place of their ids, and with minus signs. An id without an underscore is
/// a common word. The keys of a file or command stay as they are written: `viscous_asymmetry=`.
fn sentence<'t>(text: &str, title_of: impl Fn(&str) -> Option<&'t str>) -> String {
    let is_word = |letter: char| letter.is_ascii_alphanumeric() || "_.".contains(letter);
    let shown = |word: &str, after: &str| match word.trim_end_matches('.') {
        id if id.contains('_') && !after.starts_with(['=', '(']) => {
            title_of(id).map(|title| word.replacen(id, title, 1))
        }
        _ => None,
    };
    let mut with_titles = String::with_capacity(text.len());
    let mut rest = text;
    while !rest.is_empty() {
        let end = rest.find(|letter| !is_word(letter)).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        with_titles += &shown(word, after).unwrap_or_else(|| word.to_owned());
        let next = after.find(is_word).unwrap_or(after.len());
        with_titles += &after[..next];
        rest = &after[next..];
    }
    words::signed(&with_titles)
}

/// Relative change, such as `−92 %`.
pub(super) fn change_of(before: f64, after: f64) -> String {
    let share = after / before - 1.0;
    let sign = if share < 0.0 { "−" } else { "+" };
    if share.is_finite() { format!("{sign}{}", words::percent(share.abs())) } else { String::new() }
}

fn bar(share: f64) -> Markup {
    html! { span.bar style=(format!("width: {:.1}%", 100.0 * share)) {} }
}

#[cfg(test)]
mod tests {
    use super::{change_of, sentence};

    #[test]
    fn a_sentence_has_titles_and_minus_signs() {
        let title_of = |id: &str| match id {
            "load_linear" => Some("Load-dependent friction"),
            "coulomb" => Some("Coulomb friction"),
            _ => None,
        };
        let text =
            "Missing effect: load_linear (with coulomb and load_linear) at -2.5 Nm: load_linear. Set load_linear=1.";
        let shown = "Missing effect: Load-dependent friction (with coulomb and Load-dependent friction) at −2.5 Nm: \
                     Load-dependent friction. Set load_linear=1.";
        assert_eq!(sentence(text, title_of), shown);
    }

    #[test]
    fn a_change_has_a_sign() {
        assert_eq!([change_of(8.0, 1.0), change_of(1.0, 1.05), change_of(0.0, 0.0)], ["−88 %", "+5.0 %", ""]);
    }
}
