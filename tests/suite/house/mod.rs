//! Rules of the workspace: dependencies, confined libraries, licences, file sizes, and the English of its texts.

mod arrows;
mod citations;
mod licences;
mod modules;
mod sizes;
mod texts;

pub use jointbench_tests::root;
use serde_json::Value;
use std::process::Command;
use std::sync::LazyLock;

/// The packages that cargo resolved for this workspace. Needs no network: the build has downloaded all of them.
static METADATA: LazyLock<Value> = LazyLock::new(|| {
    // Libraries of other platforms are not on this machine, so the offline request is limited to the host platform.
    let version = Command::new("rustc").arg("-vV").output().expect("rustc runs").stdout;
    let version = String::from_utf8_lossy(&version).into_owned();
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).expect("rustc names its host");
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--offline", "--locked", "--filter-platform", host])
        .current_dir(root())
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "cargo metadata: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("cargo metadata prints JSON")
});

/// The packages of the whole dependency graph, by id.
fn packages() -> impl Iterator<Item = (&'static str, &'static Value)> {
    METADATA["packages"].as_array().expect("packages").iter().map(|p| (p["id"].as_str().expect("id"), p))
}

/// Ids of the packages that a package needs for build and execution, without its tests.
fn normal_dependencies(id: &str) -> Vec<&'static str> {
    let nodes = METADATA["resolve"]["nodes"].as_array().expect("nodes");
    let node = nodes.iter().find(|n| n["id"] == id).expect("a node for every package");
    let is_normal =
        |dep: &&Value| dep["dep_kinds"].as_array().is_some_and(|kinds| kinds.iter().any(|k| k["kind"].is_null()));
    node["deps"].as_array().expect("deps").iter().filter(is_normal).map(|d| d["pkg"].as_str().expect("pkg")).collect()
}
