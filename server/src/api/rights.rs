//! What a token that only reads may ask for. Whatever changes nothing, by its method; and of the other operations those
//! named here, by their routes.

use axum::http::Method;

/// They need a body, and keep nothing.
const ASKING: [&str; 6] = [
    "/api/v1/runs/import/preview",
    "/api/v1/procedures/{id}/preview",
    "/api/v1/effects/check",
    "/api/v1/models/{id}/evaluate",
    "/api/v1/tables",
    // Its handler answers a reader from what is kept.
    "/api/v1/diagnoses",
];
/// Whoever sees something going wrong may end it.
const STOPPING: [&str; 3] = ["/api/v1/bench/{bench}/stop", "/api/v1/runs/{id}/stop", "/api/v1/autopilots/{id}/stop"];
/// Who else may come in is nobody's business who only looks.
const HIDDEN: [&str; 2] = ["/api/v1/tokens", "/api/v1/tokens/{id}"];

/// `route`: the pattern of the router that the request has met; `None` for what is no operation.
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
