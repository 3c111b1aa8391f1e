//! Names and values of facts as a table.

use super::Report;
use super::number::with_own_digits;
use jiff::Timestamp;
use jointbench_instrument::units::unit_of;
use jointbench_model::words;
use jointbench_procedure::procedure;
use maud::{Markup, html};
use serde_json::{Map, Value};

impl Report {
    /// Each fact with the unit of its name: `warm_up_s` becomes warm up, 20 s.
    pub(super) fn facts(&self, values: &Map<String, Value>) -> Vec<(String, String)> {
        let fact = |(name, value): (&String, &Value)| match value {
            Value::Array(ids) if name == "baseline" => {
                let ids: Vec<&str> = ids.iter().filter_map(Value::as_str).collect();
                (words::spoken(name), ids.into_iter().map(|id| self.titled(id)).collect::<Vec<_>>().join(", "))
            }
            _ => fact(name, value),
        };
        values.iter().map(fact).collect()
    }
}

/// The facts with a value as a table.
pub fn table(facts: &[(String, String)]) -> Markup {
    html! {
        table.facts {
            @for (name, value) in facts.iter().filter(|(_, value)| !value.is_empty()) {
                tr { th { (name) } td { (value) } }
            }
        }
    }
}

pub fn fact(name: &str, value: &Value) -> (String, String) {
    (words::spoken(name), plain(value, unit_of(name).unwrap_or_default()))
}

/// A value as text, numbers with this unit.
pub fn plain(value: &Value, unit: &str) -> String {
    match value {
        Value::String(text) => moment(text),
        Value::Null => "–".to_owned(),
        Value::Bool(is_so) => if *is_so { "yes" } else { "no" }.to_owned(),
        Value::Number(number) => number.as_f64().map_or(number.to_string(), |number| with_own_digits(number, unit)),
        // The points of a curve.
        Value::Array(items) if items.iter().any(Value::is_array) => format!("{} points", items.len()),
        Value::Array(items) => items.iter().map(|item| plain(item, unit)).collect::<Vec<_>>().join(", "),
        // A part of a campaign.
        Value::Object(items) if items.contains_key("procedure") => {
            let of = |name: &str| items.get(name).map(|value| plain(value, "")).unwrap_or_default();
            let id = of("procedure");
            let name = procedure(&id).map_or(id, |procedure| procedure.title().to_owned());
            format!("{name} (from segment {})", of("first_segment"))
        }
        Value::Object(items) => {
            let facts = items.iter().map(|(name, value)| fact(name, value)).filter(|(_, text)| !text.is_empty());
            facts.map(|(name, text)| format!("{name} {text}")).collect::<Vec<_>>().join(" · ")
        }
    }
}

/// A time of the store to the second, `2026-12-01 00:56:04 UTC`; any other text unchanged.
pub fn moment(text: &str) -> String {
    let time = text.parse::<Timestamp>();
    time.map_or_else(|_| text.to_owned(), |time| time.strftime("%Y-%m-%d %H:%M:%S UTC").to_string())
}

/// The name of a file at the end of its path.
pub fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).find(|part| !part.is_empty()).unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_fact_has_its_unit_after_its_value() {
        for (name, value, shown) in [
            ("torque_constant_nm_per_a", json!(0.0406), ["torque constant", "40.6 mNm/A"]),
            ("offset_nm", json!(-2.5), ["offset", "−2.5 Nm"]),
            ("speeds_rad_s", json!([1, 20.5]), ["speeds", "1 rad/s, 20.5 rad/s"]),
            ("joint", json!({ "link_range_rad": 2.5, "note": "" }), ["joint", "link range 2.5 rad"]),
            ("imported_at", json!("2026-12-01T00:56:04.380Z"), ["imported at", "2026-12-01 00:56:04 UTC"]),
            ("serial", json!("2026-12"), ["serial", "2026-12"]),
        ] {
            let (name, text) = fact(name, &value);
            assert_eq!([name.as_str(), text.as_str()], shown);
        }
    }

    #[test]
    fn a_path_is_shown_as_its_file() {
        for (path, shown) in [("/home/a/run.csv", "run.csv"), (r"C:\data\run.csv", "run.csv"), ("run.csv", "run.csv")] {
            assert_eq!(file_name(path), shown);
        }
    }
}
