//! The result of a run that was aborted.

use jointbench_instrument::{RunTable, Trace};
use jointbench_procedure::Procedure;
use jointbench_procedure::parameter::Values;
use serde_json::Value;

/// First rows after each of which a run is cut, and number of equal parts after each of which it is cut too.
const FIRST: usize = 40;
const PARTS: usize = 16;

/// A run may be aborted at any moment: its result contains finite numbers only, as the API requires.
pub fn cut_anywhere(procedure: &dyn Procedure, values: &Values, whole: &RunTable) {
    let rows = whole.column("time_s").unwrap().len();
    for kept in (1..FIRST).chain((1..PARTS).map(|part| part * rows / PARTS)) {
        let columns =
            whole.trace().channels().iter().map(|c| whole.column(&c.name).unwrap()[..kept].to_vec()).collect();
        let trace = Trace::from_columns(whole.trace().channels().to_vec(), columns);
        let Ok(table) = RunTable::new(whole.meta().clone(), trace) else { continue };
        let Some(found) = procedure.identify(values, &table) else { continue };
        let mut places = Vec::new();
        nulls("", &serde_json::to_value(&found).unwrap(), &mut places);
        assert!(
            places.is_empty(),
            "{}, cut after {kept} of {rows} rows: {places:?}: {}",
            procedure.id(),
            found.summary
        );
    }
}

/// Places of numbers that are not finite, which JSON writes as null.
fn nulls(place: &str, json: &Value, places: &mut Vec<String>) {
    match json {
        Value::Null if !place.ends_with("/advice") && !place.ends_with("/ci95") => places.push(place.to_owned()),
        Value::Array(items) => items.iter().for_each(|item| nulls(&format!("{place}/_"), item, places)),
        Value::Object(fields) => {
            fields.iter().for_each(|(name, field)| nulls(&format!("{place}/{name}"), field, places))
        }
        _ => {}
    }
}
