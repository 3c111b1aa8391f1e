//! The main workflow in a real browser. Skipped with a message if there is none, unless `JOINTBENCH_REQUIRE_BROWSER=1`.

use crate::house::root;
use crate::program::Daemon;
use std::path::Path;
use std::process::Command;

pub fn has(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}

pub fn is_installed() -> bool {
    ["chromium", "chromium-browser", "google-chrome"].into_iter().any(has)
}

pub fn is_required() -> bool {
    std::env::var("JOINTBENCH_REQUIRE_BROWSER").as_deref() == Ok("1")
}

fn is_missing() -> Option<&'static str> {
    if !is_installed() {
        return Some("Chromium is not installed (Debian: apt-get install chromium)");
    }
    if !has("node") {
        return Some("Node is not installed");
    }
    (!root().join("web/node_modules/playwright-core").exists())
        .then_some("web/node_modules is missing: run npm ci in web/")
}

#[test]
fn an_engineer_walks_from_start_to_undo() {
    if let Some(what) = is_missing() {
        assert!(!is_required(), "the browser is required: {what}");
        eprintln!("SKIPPED: {what}. The browser tests did NOT run.");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let config = folder.path().join("bench.toml");
    let mock = |name: &str, rest: &str| format!("[[bench]]\nname = \"{name}\"\n[bench.mock]\nseed = 2\n{rest}\n");
    let text = mock("mock", "joint = \"a\"\neffects = [\"load_linear\"]")
        + &mock("encoders", "joint = \"encoder_shaft\"")
        + &mock("paced", "joint = \"a\"\npace = 5.0")
        + &mock("arm", "joint = \"puma\"");
    std::fs::write(&config, text).expect("the bench description is written");
    let daemon = Daemon::serve(&folder.path().join("data"), &config);
    let output = Command::new("node")
        .arg(root().join(Path::new("web/e2e/walk.mjs")))
        .arg(&daemon.base)
        .output()
        .expect("node runs");
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert!(output.status.success(), "{}\n{}\nthe daemon's log:\n{}", text[0], text[1], daemon.log());
}
