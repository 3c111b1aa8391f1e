//! Report of a run that can be sent and printed: a first page that is complete on one sheet, and an appendix with all
//! results, the model before and after, and the provenance.
//!
//! The report is self-contained: it loads no scripts, fonts or images.

mod figure;
mod first_page;
mod heat_map;
mod limits;
mod model;
mod number;
mod pairs;
mod provenance;
mod result;
mod sign_off;
mod style;
mod symbol;

use crate::view::{Diagnosis, Effect, Figure, Identification, Model, Run, spoken};
pub use figure::svg;
use maud::{DOCTYPE, Markup, PreEscaped, html};
pub use number::{in_one_unit, with_interval};
use pairs::{file_name, moment, plain};
use serde::{Deserialize, Serialize};
use sign_off::SignOff;
use std::collections::HashMap;

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
    /// Residual of the first and of the selected version.
    pub residual_map: Option<ResidualMap>,
    /// The effects of the run's kind by id.
    pub effects: HashMap<String, Effect>,
    /// Whether the appendix is omitted.
    pub short: bool,
}

/// Mean residual over one axis, with bands.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ResidualMap {
    pub figure: Option<Figure>,
    /// Why there is no figure.
    pub why_not: Option<String>,
}

impl Report {
    pub fn html(&self) -> String {
        let summary = &self.run.summary;
        let title = format!("Run {}: {} on {}", summary.id, summary.procedure_title(), self.bench());
        html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (title) }
                    style { (PreEscaped(style::sheet(&title, self.origin()))) }
                }
                body {
                    main {
                        (self.first_page(&title))
                        @if !self.short {
                            h1 { "Appendix" }
                            (self.course())
                            @if let Some(found) = &self.identification { (result::result(found)) }
                            @if let Some(model) = self.versions.last() { (self.model(model)) }
                            (self.provenance())
                        }
                    }
                }
            }
        }
        .into_string()
    }

    /// The origin of an imported run is unknown.
    fn origin(&self) -> &'static str {
        match (self.run.summary.simulated, self.file()) {
            (true, _) => "SIMULATED",
            (false, Some(_)) => "IMPORTED",
            (false, None) => "HARDWARE",
        }
    }

    /// Name of the imported file.
    fn file(&self) -> Option<&str> {
        self.run.provenance.get("imported")?.get("file")?.as_str().map(file_name)
    }

    /// Name of the bench; an imported run has its file there, possibly with the path.
    fn bench(&self) -> &str {
        let bench = &self.run.summary.bench;
        if self.file().is_some() { file_name(bench) } else { bench }
    }

    fn course(&self) -> Markup {
        let summary = &self.run.summary;
        html! {
            @if let Some(file) = self.file() {
                p {
                    "Data of the file " b { (file) }
                    @if let Some(source) = self.run.meta.get("source") { ", source: " (plain(source, "")) }
                    @if summary.simulated { "; according to its metadata from a simulated bench." }
                    @else { ", measured elsewhere; the bench is known from its metadata only." }
                }
            }
            p.quiet {
                (moment(&summary.created_at)) " · " (summary.state) " · " (summary.rows) " samples"
                @if let Some(duration_s) = summary.duration_s { (format!(" in {duration_s:.1} s of bench time")) }
                @if let Some(safe) = summary.safe { " · bench " (spoken(safe)) }
            }
            @if let Some(unit) = &summary.unit { p { "Unit under test " b { (unit.line()) } } }
            @if let Some(operator) = &summary.operator { p.quiet { "Operator " (operator) } }
            @if let Some(reason) = &summary.reason { p { (reason) } }
            @if !self.notes.is_empty() { ul.quiet { @for note in &self.notes { li { (self.sentence(note)) } } } }
        }
    }

    /// Known fields of the block of signatures. A run without these fields gets lines to fill in by hand.
    fn signed(&self) -> SignOff<'_> {
        let summary = &self.run.summary;
        let unit = summary.unit.as_ref();
        // `local` is a user without a token, and no name.
        let token = summary.by.as_deref().filter(|by| *by != "local");
        SignOff {
            unit: unit.and_then(|unit| unit.part.as_deref()),
            serial: unit.map(|unit| unit.serial.as_str()),
            operator: summary.operator.as_deref().or(token),
            date: None,
        }
    }
}
