//! Report of a run on one page that can be sent and printed: steps, results and model.
//!
//! The page is self-contained: it loads no scripts, fonts or images.

mod figure;
mod number;

use crate::view::{Diagnosis, Identification, Identified, Model, ParameterState, Run, Verdict, command, typed, word};
pub use figure::svg;
use jointbench_instrument::units::{quantity_of, unit_of};
use jointbench_model::words;
use jointbench_procedure::procedure;
use maud::{DOCTYPE, Markup, PreEscaped, html};
pub use number::with_interval;
use serde_json::{Map, Value};
use std::collections::{BTreeSet, HashMap};

/// Content of a report.
pub struct Report {
    pub run: Run,
    /// Notes of its events: accuracy of times, state of instruments.
    pub notes: Vec<String>,
    /// Result of its procedure.
    pub identification: Option<Identification>,
    /// The selected model version, after its ancestors.
    pub versions: Vec<Model>,
    /// Diagnosis of that version.
    pub diagnosis: Option<Diagnosis>,
    /// Titles of the effects by id.
    pub titles: HashMap<String, String>,
}

impl Report {
    pub fn html(&self) -> String {
        let summary = &self.run.summary;
        let title = format!("Run {}: {} on {}", summary.id, summary.procedure, summary.bench);
        html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (title) }
                    style { (PreEscaped(include_str!("style.css"))) }
                }
                body {
                    main {
                        h1 { (title) " " (self.badge()) }
                        (self.course())
                        @if let Some(found) = &self.identification { (result(found)) }
                        @if let Some(model) = self.versions.last() { (self.model(model)) }
                        (self.provenance())
                    }
                }
            }
        }
        .into_string()
    }

    /// The origin of an imported run is unknown.
    fn badge(&self) -> Markup {
        let word = match (self.run.summary.simulated, self.file()) {
            (true, _) => "SIMULATED",
            (false, Some(_)) => "IMPORTED",
            (false, None) => "HARDWARE",
        };
        html! { span.badge { (word) } }
    }

    /// Name of the imported file.
    fn file(&self) -> Option<&str> {
        self.run.provenance.get("imported")?.get("file")?.as_str()
    }

    fn course(&self) -> Markup {
        let summary = &self.run.summary;
        html! {
            @if let Some(file) = self.file() {
                p {
                    "Data of the file " b { (file) }
                    @if let Some(source) = self.run.meta.get("source") { ", source: " (plain(source)) }
                    @if summary.simulated { "; according to its metadata from a simulated bench." }
                    @else { ", measured elsewhere; the bench is known from its metadata only." }
                }
            }
            p.quiet {
                (summary.created_at) " · " (word(summary.state).replace('_', " ")) " · " (summary.rows) " samples"
                @if let Some(duration_s) = summary.duration_s { (format!(" in {duration_s:.1} s of bench time")) }
                @if let Some(safe) = summary.safe { " · bench " (word(safe).replace('_', " ")) }
            }
            @if let Some(unit) = &summary.unit { p { "Unit under test " b { (unit.line()) } } }
            @if let Some(operator) = &summary.operator { p.quiet { "Operator " (operator) } }
            @if let Some(reason) = &summary.reason { p { (reason) } }
            @if !self.notes.is_empty() { ul.quiet { @for note in &self.notes { li { (note) } } } }
        }
    }

    fn model(&self, model: &Model) -> Markup {
        let most = self.versions.iter().map(|version| version.validation_rms).fold(0.0, f64::max);
        let unit = &model.fit.unit;
        html! {
            h2 { "Model" }
            p { (model.effects.iter().map(|id| self.titled(id)).collect::<Vec<_>>().join(" + ")) }
            table {
                tr { th { "Version" } th { "Change" } th.figure { "Validation error" } td { } }
                @for version in &self.versions {
                    tr {
                        td { (version.id) }
                        td { (self.change(version)) }
                        td.figure { (words::figure(version.validation_rms, unit)) }
                        td width="40%" { span.bar style=(format!("width: {:.1}%", 100.0 * version.validation_rms / most)) {} }
                    }
                }
                @if let Some(floor) = model.noise_floor_rms {
                    tr {
                        td { } td { "noise floor (repeatability)" } td.figure { (words::figure(floor, unit)) }
                        td { span.bar style=(format!("width: {:.1}%", 100.0 * floor / most)) {} }
                    }
                }
            }
            table {
                tr { th { "Effect" } th { "Parameter" } th.figure { "Value" } th.figure { "95 % interval" } td { } }
                @for parameter in &model.fit.parameters {
                    @let ends = parameter.ci95[0].zip(parameter.ci95[1]).map(|(low, high)| [low, high]);
                    @let (value, interval) = with_interval(parameter.value, ends, &parameter.unit);
                    tr {
                        td { (self.titled(&parameter.effect)) } td { (parameter.name) }
                        td.figure { (value) } td.figure { (interval.unwrap_or_default()) }
                        td { @if parameter.state != ParameterState::Ok { (parameter.note.clone().unwrap_or_default()) } }
                    }
                }
            }
            @for pair in &model.fit.trade_offs {
                p.quiet { (format!("Parameter trade-off: {} and {} (correlation {:.2}).", pair.first, pair.second, pair.correlation)) }
            }
            @for note in &model.fit.notes { p.quiet { (note) } }
            @if let Some(diagnosis) = &self.diagnosis { (self.diagnosed(diagnosis)) }
        }
    }

    fn provenance(&self) -> Markup {
        let text = self.run.provenance.get("bench_description").and_then(Value::as_str);
        html! {
            h2 { "Parameters" }
            (pairs(&self.settings()))
            h2 { "Test conditions" }
            (pairs(&self.run.meta))
            h2 { "Provenance" }
            (pairs(&self.run.provenance.iter().filter(|(name, _)| *name != "bench_description")
                .map(|(name, value)| (name.clone(), value.clone())).collect()))
            @if let Some(text) = text { p { "Bench description" } pre { (text) } }
        }
    }

    /// Parameters with their titles and units from the procedure.
    fn settings(&self) -> Map<String, Value> {
        let schema = procedure(&self.run.summary.procedure).map_or(&[][..], |procedure| procedure.schema());
        let label = |name: &String| match schema.iter().find(|parameter| parameter.name == name) {
            Some(parameter) if parameter.unit.is_empty() => parameter.title.to_owned(),
            Some(parameter) => format!("{} [{}]", parameter.title, parameter.unit),
            None => title(name),
        };
        self.run.parameters.iter().map(|(name, value)| (label(name), value.clone())).collect()
    }

    fn titled<'s>(&'s self, effect: &'s str) -> &'s str {
        self.titles.get(effect).map_or(effect, String::as_str)
    }

    fn change(&self, version: &Model) -> String {
        match version.parent {
            None => "start".to_owned(),
            Some(_) => {
                let added = version.added.iter().map(|id| format!("+ {}", self.titled(id)));
                let removed = version.removed.iter().map(|id| format!("− {}", self.titled(id)));
                let reasons: BTreeSet<&str> = version.excluded.iter().map(|one| one.reason.as_str()).collect();
                let without = reasons.into_iter().map(|reason| format!("without samples: {reason}"));
                added.chain(removed).chain(without).collect::<Vec<_>>().join(", ")
            }
        }
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
        // A diagnosis with data problems is no basis for advice.
        let is_advice = found.undecided.is_none() || found.verdict == Verdict::Adequate;
        html! {
            h2 { "Diagnosis" }
            p.verdict { strong { (verdict) ". " } (found.summary) }
            @if !found.regions.is_empty() {
                p { "Regions with significant residual:" }
                ul { @for region in found.regions.iter().take(5) { li { (region.sentence) } } }
            }
            @if is_advice && !found.suggestions.is_empty() {
                p { "Missing effects:" }
                ul { @for suggestion in found.suggestions.iter().take(5) { li { strong { (self.titled(&suggestion.effect)) } ": " (suggestion.why) } } }
            }
            @if let Some(experiment) = found.experiment.as_ref().filter(|_| is_advice) { p { "Recommended next run: " (experiment.why) } }
        }
    }
}

fn result(found: &Identification) -> Markup {
    let result = &found.result;
    let verdict = match result.verdict {
        Identified::Identified => "Identified",
        Identified::IdentifiedWithWarning => "Identified with a warning",
        Identified::Inconclusive => "Inconclusive",
        Identified::Failed => "Failed",
    };
    html! {
        h2 { "Result" }
        p.verdict { strong { (verdict) ". " } (result.summary) }
        @for warning in &result.warnings { p.verdict { strong { "Warning. " } (warning) } }
        @if let Some(advice) = &result.advice { p.verdict { "Next: " (advice) } }
        @if !result.quantities.is_empty() {
            table {
                tr { th { "Quantity" } th { "Symbol" } th.figure { "Value" } th.figure { "95 % interval" } th { "Name" } }
                @for quantity in &result.quantities {
                    @let (value, interval) = with_interval(quantity.value, quantity.ci95, &quantity.unit);
                    tr {
                        td { (quantity.title) } td { (quantity.symbol) }
                        td.figure { (value) } td.figure { (interval.unwrap_or_default()) }
                        td.quiet { code { (quantity.name) } }
                    }
                }
            }
        }
        @if let Some(next) = &found.follow_up {
            p {
                "Next: " (next.why) ": " code { (command(&next.procedure, &next.parameters)) }
            }
        }
        @for one in &result.figures {
            @if let Some(svg) = figure::svg(one) {
                figure { figcaption { (one.title) } (PreEscaped(svg)) }
            }
        }
        p.quiet { "Computed by " (found.software) "." }
    }
}

fn pairs(values: &Map<String, Value>) -> Markup {
    html! {
        table {
            @for (name, value) in values.iter().filter(|(_, value)| !plain(value).is_empty()) {
                tr { td { (title(name)) } td { (plain(value)) } }
            }
        }
    }
}

/// Title of a parameter: `warm_up_s` becomes warm up [s].
fn title(name: &str) -> String {
    let quantity = quantity_of(name).unwrap_or(name).replace('_', " ");
    unit_of(name).map_or(quantity.clone(), |unit| format!("{quantity} [{unit}]"))
}

fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => "–".to_owned(),
        Value::Array(items) => items.iter().map(plain).collect::<Vec<_>>().join(", "),
        // A part of a campaign.
        Value::Object(items) if items.contains_key("procedure") => {
            let of = |name: &str| items.get(name).map(plain).unwrap_or_default();
            let id = of("procedure");
            let name = procedure(&id).map_or(id, |procedure| procedure.title().to_owned());
            format!("{name} (from segment {})", of("first_segment"))
        }
        Value::Object(items) => {
            let labelled = |(name, value): (&String, &Value)| match plain(value) {
                text if text.is_empty() => None,
                text => Some(format!("{} {text}", title(name))),
            };
            items.iter().filter_map(labelled).collect::<Vec<_>>().join(" · ")
        }
        other => typed(other),
    }
}
