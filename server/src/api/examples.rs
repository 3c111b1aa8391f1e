//! Examples of responses in the OpenAPI description: `examples.json` has one for each schema, or operation without one.

use serde_json::Value;
use std::collections::BTreeMap;
use utoipa::openapi::example::{Example, ExampleBuilder};
use utoipa::openapi::path::{Operation, PathItem};
use utoipa::openapi::{Content, OpenApi, Ref, RefOr};

const EXAMPLES: &str = include_str!("../../examples.json");

/// Adds the examples to the components, and references to the successful JSON responses.
pub fn added(mut document: OpenApi) -> OpenApi {
    let examples: BTreeMap<String, Value> = serde_json::from_str(EXAMPLES).unwrap_or_default();
    for item in document.paths.paths.values_mut() {
        let PathItem { get, put, post, delete, .. } = item;
        [get, put, post, delete].into_iter().flatten().for_each(|operation| add(operation, &examples));
    }
    let example = |value| RefOr::T(ExampleBuilder::new().value(Some(value)).build());
    let kept = examples.into_iter().map(|(name, value)| (name, example(value)));
    document.components.get_or_insert_default().examples.extend(kept);
    document
}

fn add(operation: &mut Operation, examples: &BTreeMap<String, Value>) {
    let id = operation.operation_id.clone().unwrap_or_default();
    let successes = operation.responses.responses.iter_mut().filter(|(status, _)| status.starts_with('2'));
    for (_, response) in successes {
        let RefOr::T(response) = response else { continue };
        let Some(RefOr::T(content)) = response.content.get_mut("application/json") else { continue };
        let names = [Some(id.clone()), schema_name(content)];
        if let Some(name) = names.into_iter().flatten().find(|name| examples.contains_key(name)) {
            content.examples.insert("response".to_owned(), reference(&name));
        }
    }
}

fn schema_name(content: &Content) -> Option<String> {
    match &content.schema {
        Some(RefOr::Ref(of)) => of.ref_location.rsplit('/').next().map(str::to_owned),
        _ => None,
    }
}

fn reference(name: &str) -> RefOr<Example> {
    RefOr::Ref(Ref::new(format!("#/components/examples/{name}")))
}
