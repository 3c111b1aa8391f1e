//! States the revision of a release build in `jointbench --version` and in the provenance of runs. Other builds state the
//! version only, so that a commit does not recompile them.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if std::env::var("PROFILE").is_ok_and(|profile| profile != "release") {
        return;
    }
    // Without git or outside of a repository, the version is stated alone.
    let (Some(folder), Some(revision)) =
        (git(&["rev-parse", "--absolute-git-dir"]), git(&["rev-parse", "--short=8", "HEAD"]))
    else {
        return;
    };
    let log = Path::new(&folder).join("logs/HEAD");
    if log.exists() {
        println!("cargo:rerun-if-changed={}", log.display());
    }
    println!("cargo:rustc-env=JOINTBENCH_VERSION={} ({revision})", env!("CARGO_PKG_VERSION"));
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    String::from_utf8(output.stdout).ok().map(|text| text.trim().to_owned())
}
