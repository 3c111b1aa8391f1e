//! The OpenAPI description is a file of the repository: the types of the dashboard are generated from it before the build.

/// Set to write `openapi.json` anew after a wanted change of the API.
const BLESS: &str = "JOINTBENCH_BLESS";

#[test]
fn the_kept_specification_is_the_routers() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/openapi.json");
    let now = super::specification().to_pretty_json().unwrap() + "\n";
    if std::env::var_os(BLESS).is_some() {
        std::fs::write(path, &now).unwrap();
    }
    let kept = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        kept == now,
        "server/openapi.json differs from the router: run the tests once with {BLESS}=1 and commit it"
    );
}

#[test]
fn files_are_binary_and_named_by_their_kind() {
    let document = serde_json::to_value(super::specification()).unwrap();
    for (path, method, kinds) in [("/api/v1/runs/{id}/export", "get", 3), ("/api/v1/tables", "post", 2)] {
        let content = document["paths"][path][method]["responses"]["200"]["content"].as_object().unwrap();
        assert_eq!(content.len(), kinds, "{path}: {content:?}");
        let file = content.values().all(|one| one["schema"]["$ref"] == "#/components/schemas/File");
        assert!(file, "{path}: {content:?}");
    }
    let file = &document["components"]["schemas"]["File"];
    assert_eq!((&file["type"], &file["format"]), (&"string".into(), &"binary".into()));
    assert_eq!(document["servers"][0]["url"], "/");
}

#[test]
fn every_response_is_described() {
    let document = serde_json::to_value(super::specification()).unwrap();
    assert_eq!(document["openapi"], "3.1.0");
    let mut operations = 0;
    let mut names = std::collections::HashSet::new();
    for (path, item) in document["paths"].as_object().unwrap() {
        for (method, operation) in item.as_object().unwrap().iter().filter(|(_, o)| o.get("responses").is_some()) {
            operations += 1;
            let changes = method != "get";
            for (status, expected) in [("404", path.contains('{')), ("409", changes)] {
                assert!(
                    !expected || operation["responses"][status].is_object(),
                    "{method} {path}: {status} is missing"
                );
            }
            let name = operation["operationId"].as_str().unwrap();
            assert!(
                names.insert(name.to_owned()),
                "{method} {path}: two operations are called {name}; name one with operation_id"
            );
            assert!(name.contains('_'), "{method} {path}: {name} is not a verb with its object");
            assert!(operation["summary"].is_string() && operation["tags"].is_array(), "{method} {path}");
            for parameter in operation["parameters"].as_array().into_iter().flatten() {
                assert!(parameter["description"].is_string(), "{method} {path}: {parameter} has no description");
            }
            for (status, response) in operation["responses"].as_object().unwrap() {
                let described = response["description"].as_str().is_some_and(|text| !text.is_empty());
                assert!(described, "{method} {path}: response {status} has no description");
            }
        }
    }
    assert!(operations >= 27, "{operations} operations");
}
