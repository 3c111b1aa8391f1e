//! Refusals and files in the OpenAPI description.

use std::collections::BTreeMap;
use utoipa::openapi::path::{Operation, PathItem};
use utoipa::openapi::{Content, OpenApi, RefOr, Response, ResponseBuilder, schema::Ref};
use utoipa::{IntoResponses, ToSchema};

/// The documented form of every refusal.
pub struct Refusals;

impl IntoResponses for Refusals {
    fn responses() -> BTreeMap<String, RefOr<Response>> {
        let description = "Error: a problem document (RFC 9457) with cause and remedy";
        BTreeMap::from([("default".to_owned(), problem(description))])
    }
}

/// A file, byte for byte.
#[derive(ToSchema)]
#[schema(value_type = String, format = Binary)]
#[allow(dead_code, reason = "describes a body in the specification")]
pub struct File(Vec<u8>);

fn problem(description: &str) -> RefOr<Response> {
    let content = Content::new(Some(Ref::from_schema_name("Problem")));
    RefOr::T(ResponseBuilder::new().description(description).content("application/problem+json", content).build())
}

/// Adds the refusals that follow from the parameters and the body of an operation.
pub fn named(mut document: OpenApi) -> OpenApi {
    for (path, item) in &mut document.paths.paths {
        let PathItem { get, put, post, delete, .. } = item;
        let reading = get.iter_mut().map(|operation| (operation, false));
        let changing = [put, post, delete].into_iter().flatten().map(|operation| (operation, true));
        reading.chain(changing).for_each(|(operation, changes)| name(operation, path, changes));
    }
    document
}

fn name(operation: &mut Operation, path: &str, changes: bool) {
    let takes = operation.request_body.is_some();
    let chooses = takes || operation.parameters.as_ref().is_some_and(|all| !all.is_empty());
    let refusals = [
        (chooses, "400", "The request is malformed"),
        (path.contains('{') || takes, "404", "What the request names does not exist"),
        (changes, "409", "Not possible in the present state: a run is in progress, or the item has ended or changed"),
        (chooses, "422", "A value is not valid; `detail` says which, and what is valid"),
    ];
    for (_, status, description) in refusals.into_iter().filter(|(applies, ..)| *applies) {
        operation.responses.responses.entry(status.to_owned()).or_insert_with(|| problem(description));
    }
}
