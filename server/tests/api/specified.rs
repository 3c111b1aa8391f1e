//! Responses and the specification: each response to the client of the tests is valid for the schema of its operation.

use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::sync::LazyLock;

static DOCUMENT: LazyLock<Value> =
    LazyLock::new(|| serde_json::from_str(include_str!("../../openapi.json")).expect("the specification is JSON"));

/// Fails if a successful response is not valid for its schema.
pub fn check(method: &str, path: &str, status: u16, body: &Value) {
    let path = path.split('?').next().unwrap_or(path);
    if !(200..300).contains(&status) {
        return;
    }
    let Some(schema) = response(method, path, status) else { return };
    valid(schema, body, true, "").unwrap_or_else(|fault| panic!("{method} {path} {status}: {fault}\n{body}"));
}

/// The schema of the JSON with this status. An operation with a fixed path has precedence over one with a placeholder.
fn response(method: &str, path: &str, status: u16) -> Option<&'static Value> {
    let fits = |template: &str| {
        let mut parts = template.split('/').zip(path.split('/'));
        template.split('/').count() == path.split('/').count()
            && parts.all(|(expected, part)| expected == part || expected.starts_with('{'))
    };
    let paths = DOCUMENT["paths"].as_object()?.iter().filter(|(template, _)| fits(template));
    let (_, item) = paths.min_by_key(|(template, _)| template.matches('{').count())?;
    item.get(method)?["responses"].get(status.to_string())?["content"].get("application/json")?.get("schema")
}

/// `closed`: a field without a schema is an error. The parts of `allOf` are open, because each has only some fields.
fn valid(schema: &Value, value: &Value, closed: bool, at: &str) -> Result<(), String> {
    let Some(schema) = schema.as_object() else { return Ok(()) };
    if let Some(reference) = schema.get("$ref").and_then(Value::as_str) {
        let name = reference.rsplit('/').next().unwrap_or_default();
        valid(&DOCUMENT["components"]["schemas"][name], value, closed, at)?;
    }
    let list = |key: &str| schema.get(key).and_then(Value::as_array);
    for one in list("allOf").into_iter().flatten() {
        valid(one, value, false, at)?;
    }
    if let Some(choices) = list("oneOf").or_else(|| list("anyOf")) {
        let faults: Vec<_> = choices.iter().map(|one| valid(one, value, closed, at)).collect();
        if faults.iter().all(Result::is_err) {
            return Err(format!("{at}: no alternative is valid: {faults:?}"));
        }
    }
    if list("enum").is_some_and(|words| !words.contains(value)) {
        return Err(format!("{at}: {value} is no value of {:?}", schema["enum"]));
    }
    let types = schema.get("type").map(|one| one.as_array().cloned().unwrap_or_else(|| vec![one.clone()]));
    if types.is_some_and(|types| !types.iter().any(|one| is_of(value, one.as_str().unwrap_or_default()))) {
        return Err(format!("{at}: {value} is not of type {}", schema["type"]));
    }
    match value {
        Value::Object(fields) => valid_fields(schema, fields, closed, at),
        Value::Array(items) => {
            let of = |i: usize| list("prefixItems").and_then(|all| all.get(i)).or_else(|| schema.get("items"));
            let mut each = items.iter().enumerate().filter_map(|(i, item)| Some((i, of(i)?, item)));
            each.try_for_each(|(i, schema, item)| valid(schema, item, true, &format!("{at}/{i}")))
        }
        _ => Ok(()),
    }
}

fn is_of(value: &Value, kind: &str) -> bool {
    match kind {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("{other} is no type of JSON"),
    }
}

fn valid_fields(
    schema: &Map<String, Value>,
    fields: &Map<String, Value>,
    closed: bool,
    at: &str,
) -> Result<(), String> {
    let required = schema.get("required").and_then(Value::as_array).into_iter().flatten();
    if let Some(missing) = required.filter_map(Value::as_str).find(|name| !fields.contains_key(*name)) {
        return Err(format!("{at}: {missing} is missing"));
    }
    let properties = schema.get("properties").and_then(Value::as_object);
    for (name, value) in fields {
        let at = format!("{at}/{name}");
        match properties.and_then(|all| all.get(name)).or_else(|| schema.get("additionalProperties")) {
            Some(schema) => valid(schema, value, true, &at)?,
            None if closed && properties.is_some() => return Err(format!("{at} is not specified")),
            None => {}
        }
    }
    Ok(())
}

#[test]
fn a_response_outside_its_schema_is_found() {
    let schema = response("get", "/api/v1/effects", 200).expect("an operation with JSON");
    let effect = json!({ "id": "viscous", "kind": "friction", "title": "", "sentence": "", "formula": "", "needs": [],
        "parameters": [{ "name": "c_v", "symbol": "c_v", "unit": "Nm·s/rad", "min": 0, "max": null }] });
    let fault = |change: &dyn Fn(&mut Value)| {
        let mut effects = json!([effect]);
        change(&mut effects[0]);
        valid(schema, &effects, true, "").err().unwrap_or_default()
    };
    assert_eq!(fault(&|_| {}), "");
    assert_eq!(fault(&|effect| effect["kind"] = json!(1)), "/0/kind: 1 is not of type \"string\"");
    assert_eq!(fault(&|effect| effect["more"] = json!(1)), "/0/more is not specified");
    let without_symbol = |effect: &mut Value| drop(effect["parameters"][0].as_object_mut().unwrap().remove("symbol"));
    assert_eq!(fault(&without_symbol), "/0/parameters/0: symbol is missing");
}

/// `server/examples.json` has no example that is not used.
#[test]
fn every_json_operation_has_a_valid_example() {
    let examples = DOCUMENT["components"]["examples"].as_object().expect("examples");
    let mut unused: BTreeSet<&str> = examples.keys().map(String::as_str).collect();
    for (path, item) in DOCUMENT["paths"].as_object().expect("paths") {
        let operations = item.as_object().into_iter().flatten();
        for (method, operation) in operations {
            let responses = operation["responses"].as_object().into_iter().flatten();
            for (status, response) in responses.filter(|(status, _)| status.starts_with('2')) {
                let Some(json) = response["content"].get("application/json") else { continue };
                let place = format!("{method} {path} {status}");
                let reference = json["examples"]["response"]["$ref"].as_str().unwrap_or_default();
                let name = reference.rsplit('/').next().unwrap_or_default();
                let example = examples.get(name).unwrap_or_else(|| panic!("{place} has no example"));
                valid(&json["schema"], &example["value"], true, "").unwrap_or_else(|fault| panic!("{place}: {fault}"));
                unused.remove(name);
            }
        }
    }
    assert!(unused.is_empty(), "no operation uses the examples {unused:?}");
}
