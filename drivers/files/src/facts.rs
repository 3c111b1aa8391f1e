//! The facts of a table: one JSON object, in its own file or embedded.

use crate::error::{FileError, FileFault};
use jointbench_instrument::spelling::plainly;
use jointbench_instrument::{Channel, FactShape, Meta};
use serde_json::{Map, Value};
use std::fs;
use std::path::{Path, PathBuf};

/// Key of the facts as JSON in a Parquet or Arrow file.
pub(crate) const EMBEDDED: &str = "meta";
/// Key of the columns' resolutions in the facts. Only in tables that this program has written.
const RESOLUTION: &str = "resolution";

/// Reads the facts from JSON. `name` appears in messages.
pub fn parse_meta(name: &str, json: &[u8]) -> Result<Meta, FileError> {
    let line_of = |fact: &str| {
        let text = String::from_utf8_lossy(json);
        let before = text.split(&format!("\"{fact}\"")).next().unwrap_or_default();
        before.matches('\n').count() as u64 + 1
    };
    let meta: Meta = serde_json::from_slice(json).map_err(|fault| {
        if let Some((fact, fault)) = mistyped(json) {
            return fault.at_line(name, line_of(&fact));
        }
        let text = fault.to_string();
        // serde_json appends the position, with which the message already starts.
        let what = plainly(text.rsplit_once(" at line ").map_or(text.as_str(), |(what, _)| what));
        match fault.line() {
            0 => FileFault::Meta { what }.in_file(name),
            line => FileFault::Meta { what }.at_line(name, line as u64),
        }
    })?;
    match meta.misspelt() {
        Some((found, meant)) => {
            Err(FileFault::Misspelt { found: found.to_owned(), meant }.at_line(name, line_of(found)))
        }
        None => Ok(meta),
    }
}

/// The first fact whose value has another shape than the fact expects.
fn mistyped(json: &[u8]) -> Option<(String, FileFault)> {
    let facts: Map<String, Value> = serde_json::from_slice(json).ok()?;
    facts.into_iter().find_map(|(fact, value)| {
        let (_, shape) = Meta::FACTS.into_iter().find(|(known, _)| *known == fact)?;
        let expected = match shape {
            FactShape::Word => "a word in quotes",
            FactShape::Flag => "true or false, without quotes",
            FactShape::Number => "a number without quotes, such as 50",
            FactShape::WholeNumber => "a whole number without quotes, such as 12",
            FactShape::List => "a list, such as [\"coulomb\", \"viscous\"]",
        };
        let (found, fits) = (value.to_string(), shape.fits(&value));
        let is_read = serde_json::from_value::<Meta>(Value::Object(Map::from_iter([(fact.clone(), value)]))).is_ok();
        (!fits && !is_read).then(|| (fact.clone(), FileFault::Fact { fact, found, expected }))
    })
}

pub(crate) fn read_meta(path: &Path) -> Result<Meta, FileError> {
    let name = path.display().to_string();
    let json = fs::read(path).map_err(|fault| FileFault::Io(fault).in_file(&name))?;
    parse_meta(&name, &json)
}

/// `run-12.csv.gz` → `run-12.meta.json` in the same folder: the path of the facts that [`crate::write`] uses for a CSV.
pub fn meta_path_of(table: &Path) -> PathBuf {
    let name = table.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.split('.').next().unwrap_or_default();
    table.with_file_name(format!("{stem}.meta.json"))
}

pub(crate) fn beside(table: &Path) -> Option<PathBuf> {
    [meta_path_of(table), table.with_file_name("meta.json")].into_iter().find(|path| path.is_file())
}

/// The facts of a run as JSON, with the resolutions of its columns.
pub fn meta_json(meta: &Meta, channels: &[Channel]) -> String {
    let mut meta = meta.clone();
    let steps: Map<String, Value> =
        channels.iter().filter_map(|c| Some((c.name.clone(), Value::from(c.resolution?)))).collect();
    if !steps.is_empty() {
        meta.other.insert(RESOLUTION.to_owned(), Value::Object(steps));
    }
    serde_json::to_string_pretty(&meta).expect("facts are plain JSON")
}

/// Removes the resolutions of the named columns from the facts. Other values under that key are kept.
pub(crate) fn take_resolutions(meta: &mut Meta, names: &[String]) -> Vec<Channel> {
    let mut steps = match meta.other.get_mut(RESOLUTION) {
        Some(Value::Object(steps)) => std::mem::take(steps),
        _ => Map::new(),
    };
    let channels = names
        .iter()
        .map(|name| match steps.get(name).and_then(Value::as_f64).filter(|step| *step > 0.0) {
            Some(step) => {
                steps.remove(name);
                Channel::counted(name, step)
            }
            None => Channel::new(name),
        })
        .collect();
    match meta.other.get_mut(RESOLUTION) {
        Some(Value::Object(left)) if !steps.is_empty() => *left = steps,
        Some(Value::Object(_)) => {
            meta.other.remove(RESOLUTION);
        }
        _ => {}
    }
    channels
}
