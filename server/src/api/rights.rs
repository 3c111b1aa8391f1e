//! Operations that a read token allows: every safe method, and the other operations that are listed here by route.

use axum::http::Method;

/// They need a body, but store nothing.
const ASKING: [&str; 6] = [
    "/api/v1/runs/import/preview",
    "/api/v1/procedures/{id}/preview",
    "/api/v1/effects/check",
    "/api/v1/models/{id}/evaluate",
    "/api/v1/tables",
    // The handler answers a read token from stored results.
    "/api/v1/diagnoses",
];
/// Every user may end a run.
const STOPPING: [&str; 3] = ["/api/v1/bench/{bench}/stop", "/api/v1/runs/{id}/stop", "/api/v1/autopilots/{id}/stop"];
/// A read token does not allow to list tokens.
const HIDDEN: [&str; 2] = ["/api/v1/tokens", "/api/v1/tokens/{id}"];

/// `route`: the matching pattern of the router; `None` if the request is not an operation.
pub fn reader_may(method: &Method, route: Option<&str>) -> bool {
    let Some(route) = route else { return method.is_safe() };
    if method.is_safe() {
        return !HIDDEN.contains(&route);
    }
    *method == Method::POST && (ASKING.contains(&route) || STOPPING.contains(&route))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_named_route_is_an_operation() {
        let document = serde_json::to_value(crate::api::specification()).unwrap();
        for route in ASKING.iter().chain(&STOPPING) {
            assert!(document["paths"][route]["post"].is_object(), "{route}");
        }
        for route in HIDDEN {
            assert!(document["paths"][route].is_object(), "{route}");
        }
    }

    #[test]
    fn a_reader_changes_nothing_by_method_and_not_by_the_end_of_a_path() {
        let document = serde_json::to_value(crate::api::specification()).unwrap();
        let mut may = Vec::new();
        for (route, operations) in document["paths"].as_object().unwrap() {
            for method in [Method::POST, Method::PUT, Method::PATCH, Method::DELETE] {
                let name = method.as_str().to_lowercase();
                if operations.get(name).is_some() && reader_may(&method, Some(route)) {
                    may.push(route.as_str());
                }
            }
        }
        may.sort_unstable();
        let mut named = [ASKING.as_slice(), STOPPING.as_slice()].concat();
        named.sort_unstable();
        assert_eq!(may, named);
        assert!(!reader_may(&Method::POST, None) && !reader_may(&Method::DELETE, Some("/api/v1/tables")));
        assert!(reader_may(&Method::GET, None) && !reader_may(&Method::GET, Some("/api/v1/tokens")));
    }
}
