//! Names and values of facts as a table.

use crate::view::typed;
use jointbench_instrument::units::unit_of;
use jointbench_model::words;
use jointbench_procedure::procedure;
use maud::{Markup, html};
use serde_json::{Map, Value};

pub fn pairs(values: &Map<String, Value>) -> Markup {
    html! {
        table.facts {
            @for (name, value) in values.iter().filter(|(_, value)| !plain(value).is_empty()) {
                tr { th { (title(name)) } td { (plain(value)) } }
            }
        }
    }
}

/// Title of a parameter: `warm_up_s` becomes warm up [s].
pub fn title(name: &str) -> String {
    let quantity = words::spoken(name);
    unit_of(name).map_or(quantity.clone(), |unit| format!("{quantity} [{unit}]"))
}

pub fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => "–".to_owned(),
        // The points of a curve.
        Value::Array(items) if items.iter().any(Value::is_array) => format!("{} points", items.len()),
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
