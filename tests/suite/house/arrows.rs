//! Dependencies point downwards. The table corresponds to the drawing in ARCHITECTURE.md.

use super::{METADATA, normal_dependencies, packages};
use std::collections::{BTreeMap, BTreeSet};

/// Each crate of the workspace, its folder, and the crates of the workspace that it may depend on.
const HOUSE: [(&str, &str, &[&str]); 7] = [
    ("jointbench-instrument", "drivers/instrument", &[]),
    ("jointbench-devices", "drivers/devices", &["jointbench-instrument"]),
    ("jointbench-files", "drivers/files", &["jointbench-instrument"]),
    ("jointbench-model", "procedures/model", &["jointbench-instrument"]),
    ("jointbench-procedure", "procedures/procedure", &["jointbench-instrument", "jointbench-model"]),
    ("jointbench-ui", "web", &[]),
    (
        "jointbench",
        "server",
        &[
            "jointbench-instrument",
            "jointbench-devices",
            "jointbench-files",
            "jointbench-model",
            "jointbench-procedure",
            "jointbench-ui",
        ],
    ),
];

/// Libraries that only the named crates may use, directly or indirectly.
const CONFINED: [(&str, &[&str]); 5] = [
    ("tokio", &["jointbench"]),
    ("axum", &["jointbench"]),
    ("sqlx", &["jointbench"]),
    ("serialport", &["jointbench", "jointbench-devices"]),
    ("rustix", &["jointbench", "jointbench-devices"]),
];

fn house_ids() -> BTreeMap<&'static str, (&'static str, String)> {
    let member = |id: &str| METADATA["workspace_members"].as_array().is_some_and(|m| m.iter().any(|w| w == id));
    packages()
        .filter(|(id, _)| member(id))
        .map(|(id, p)| (p["name"].as_str().unwrap(), (id, p["manifest_path"].as_str().unwrap().to_owned())))
        .collect()
}

fn reach(id: &'static str) -> BTreeSet<&'static str> {
    let (mut seen, mut open) = (BTreeSet::new(), vec![id]);
    while let Some(next) = open.pop() {
        for dependency in normal_dependencies(next) {
            if seen.insert(dependency) {
                open.push(dependency);
            }
        }
    }
    seen
}

#[test]
fn every_crate_leans_only_on_what_is_below_it() {
    let ids = house_ids();
    for (name, folder, allowed) in HOUSE {
        let (id, manifest) = &ids[name];
        assert!(manifest.ends_with(&format!("/{folder}/Cargo.toml")), "{name} lives in {folder}, not {manifest}");
        for dependency in normal_dependencies(id) {
            if let Some((other, _)) = ids.iter().find(|(_, (other_id, _))| *other_id == dependency) {
                assert!(allowed.contains(other), "{name} must not lean on {other}");
            }
        }
    }
    let known: BTreeSet<&str> = HOUSE.iter().map(|(name, ..)| *name).chain(["jointbench-tests"]).collect();
    assert_eq!(ids.keys().copied().collect::<BTreeSet<_>>(), known, "a new crate belongs into this drawing");
}

#[test]
fn what_is_absent_stays_absent() {
    let ids = house_ids();
    let by_id: BTreeMap<&str, &str> = packages().map(|(id, p)| (id, p["name"].as_str().unwrap())).collect();
    for (name, _, _) in HOUSE {
        let reached: BTreeSet<&str> = reach(ids[name].0).into_iter().map(|id| by_id[id]).collect();
        for (library, homes) in CONFINED {
            assert!(homes.contains(&name) || !reached.contains(library), "{name} must not reach {library}");
        }
    }
}

/// The mock bench and the models must be independent: neither may depend on the other.
#[test]
fn the_mock_bench_and_the_models_share_no_code() {
    let ids = house_ids();
    assert!(!reach(ids["jointbench-devices"].0).contains(ids["jointbench-model"].0));
    assert!(!reach(ids["jointbench-model"].0).contains(ids["jointbench-devices"].0));
}
