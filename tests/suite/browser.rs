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

/// Whether the browser tests run. They must if the browser is required.
fn is_ready() -> bool {
    let missing = is_missing();
    if let Some(what) = missing {
        assert!(!is_required(), "the browser is required: {what}");
        eprintln!("SKIPPED: {what}. The browser tests did NOT run.");
    }
    missing.is_none()
}

/// Carries out a story of `web/e2e` with a daemon of this bench description.
fn play(story: &str, folder: &Path, text: &str) {
    let config = folder.join("bench.toml");
    std::fs::write(&config, text).expect("the bench description is written");
    let daemon = Daemon::serve(&folder.join("data"), &config);
    let output =
        Command::new("node").arg(root().join("web/e2e").join(story)).arg(&daemon.base).output().expect("node runs");
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert!(output.status.success(), "{}\n{}\nthe daemon's log:\n{}", text[0], text[1], daemon.log());
}

#[test]
fn archived_runs_and_empty_charts_have_a_reason() {
    if !is_ready() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let archive = folder.path().join("archive");
    std::fs::create_dir(&archive).expect("a folder");
    let archive = format!("[archive]\nurl = \"file://{}\"\nraw = true\n", archive.display());
    play("states.mjs", folder.path(), &format!("{archive}[[bench]]\nname = \"mock\"\n[bench.mock]\njoint = \"a\"\n"));
}

#[test]
fn an_engineer_walks_from_start_to_undo() {
    if !is_ready() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let mock = |name: &str, rest: &str| format!("[[bench]]\nname = \"{name}\"\n[bench.mock]\nseed = 2\n{rest}\n");
    let text = mock("mock", "joint = \"a\"\neffects = [\"load_linear\"]")
        + &mock("encoders", "joint = \"encoder_shaft\"")
        + &mock("paced", "joint = \"a\"\npace = 5.0")
        + &mock("arm", "joint = \"puma\"");
    play("walk.mjs", folder.path(), &text);
}
