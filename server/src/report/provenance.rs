//! Origin of the figures: run, program, instruments and settings as tables.

use super::Report;
use super::pairs::{fact, moment, plain, table};
use jointbench_procedure::parameter::{Parameter, ParameterKind};
use jointbench_procedure::procedure;
use maud::{Markup, html};
use serde_json::{Map, Value};

/// Facts with a place of their own in the tables.
const PLACED: [&str; 11] = [
    "acceptance_limits",
    "bench_description",
    "by",
    "calibrated",
    "constants",
    "imported",
    "instruments",
    "limits",
    "seed",
    "simulated",
    "software",
];

impl Report {
    pub(super) fn provenance(&self) -> Markup {
        let of = |name: &str| self.run.provenance.get(name);
        let group = |name: &str| of(name).and_then(Value::as_object).filter(|values| !values.is_empty());
        let text = of("bench_description").and_then(Value::as_str).filter(|text| !text.trim().is_empty());
        let others = self.run.provenance.iter().filter(|(name, _)| !PLACED.contains(&name.as_str()));
        let others: Map<String, Value> = others.map(|(name, value)| (name.clone(), value.clone())).collect();
        html! {
            h2 { "Provenance" }
            table.facts { @for (name, value) in self.origins() { tr { th { (name) } td { (value) } } } }
            (self.instruments())
            (section("Settings", &self.settings()))
            (section("Test conditions", &self.facts(&self.run.meta)))
            @if let Some(constants) = group("constants") { (section("Constants of the bench", &self.facts(constants))) }
            @if let Some(limits) = group("limits") { (section("Limits of the bench", &self.facts(limits))) }
            @if let Some(source) = group("imported") { (section("Imported data", &self.facts(source))) }
            (section("Further facts", &self.facts(&others)))
            @if let Some(text) = text { h3 { "Bench description" } pre { (text) } }
            @if let Some(file) = of("acceptance_limits") {
                h3 { "Limits file" }
                p.quiet { "SHA-256 " (plain(&file["sha256"], "")) }
                pre { (plain(&file["text"], "")) }
            }
        }
    }

    /// Run, times, people and programs.
    fn origins(&self) -> Vec<(&'static str, String)> {
        let summary = &self.run.summary;
        let of =
            |name: &str| self.run.provenance.get(name).map(|value| plain(value, "")).filter(|text| !text.is_empty());
        let mut facts = vec![
            ("Run", summary.id.to_string()),
            ("Bench", format!("{} ({})", self.bench(), self.origin().to_lowercase())),
            ("Procedure", format!("{} ({})", summary.procedure_title(), summary.procedure)),
            ("Started", moment(&summary.created_at)),
        ];
        let more = [
            ("Finished", summary.finished_at.as_deref().map(moment)),
            ("End state", Some(summary.state.to_string())),
            ("Samples", Some(format!("{} rows, {} channels", summary.rows, self.run.channels.len()))),
            ("Data integrity", Some("stored records have checksums, verified at each read".to_owned())),
            ("User", of("by").or_else(|| summary.by.clone())),
            ("Random seed", of("seed")),
            ("Measured or imported with", of("software")),
            ("Model version", self.versions.last().map(|model| self.version(model.id, &model.created_at))),
            ("Report computed with", Some(program())),
        ];
        facts.extend(more.into_iter().filter_map(|(name, value)| Some((name, value?))));
        facts
    }

    fn version(&self, id: i64, created_at: &str) -> String {
        let by = self.versions.last().and_then(|model| model.by.as_deref()).unwrap_or("an unknown user");
        format!("{id}, fitted {} by {by}", moment(created_at))
    }

    /// Identity and calibration of each instrument at the start of the run.
    fn instruments(&self) -> Markup {
        let all = self.run.provenance.get("instruments").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        let calibrated = self.run.provenance.get("calibrated");
        let text = |value: Option<&Value>| value.and_then(Value::as_str).unwrap_or_default().to_owned();
        let known = |value: Option<&Value>| Some(text(value)).filter(|text| !text.is_empty()).unwrap_or("–".into());
        html! {
            @if !all.is_empty() {
                h3 { "Instruments" }
                table {
                    tr {
                        th { "Role" } th { "Instrument" } th { "Serial number" } th { "Firmware" } th { "Connection" }
                        th { "Calibrated" }
                    }
                    @for one in all {
                        @let of = |name: &str| one.get("identity").and_then(|identity| identity.get(name));
                        @let role = text(one.get("role"));
                        @let day = calibrated.and_then(|days| days.get(&role));
                        tr {
                            td { (known(one.get("name").or(one.get("role"))).replace('_', " ")) }
                            td { (text(of("maker"))) " " (text(of("model"))) }
                            td { (known(of("serial"))) }
                            td { (known(of("firmware"))) }
                            td { (known(one.get("driver"))) ", " (known(one.get("port"))) }
                            td { @if day.is_some() { (known(day)) } @else { "not stated" } }
                        }
                    }
                }
            }
        }
    }

    /// Parameters with their titles and units from the procedure.
    fn settings(&self) -> Vec<(String, String)> {
        let schema = procedure(&self.run.summary.procedure).map_or(&[][..], |procedure| procedure.schema());
        let setting = |(name, value): (&String, &Value)| {
            let known = schema.iter().find(|parameter| parameter.name == name);
            known.map_or_else(|| fact(name, value), |known| (known.title.to_owned(), setting_text(known, value)))
        };
        self.run.parameters.iter().map(setting).collect()
    }
}

fn setting_text(parameter: &Parameter, value: &Value) -> String {
    match (parameter.kind, value.as_f64()) {
        (ParameterKind::Fraction, Some(value)) => parameter.text(value),
        _ => plain(value, parameter.unit),
    }
}

fn section(heading: &str, facts: &[(String, String)]) -> Markup {
    html! { @if !facts.is_empty() { h3 { (heading) } (table(facts)) } }
}

/// The running program, with its revision if the build stated one.
fn program() -> String {
    let version = concat!("jointbench ", env!("CARGO_PKG_VERSION"));
    option_env!("JOINTBENCH_REVISION").map_or(version.to_owned(), |revision| format!("{version}, revision {revision}"))
}
