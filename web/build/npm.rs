//! npm, called so that several cargo builds (debug, release, clippy, an editor) may come at the same time.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};

const NPM: &str = if cfg!(windows) { "npm.cmd" } else { "npm" };

/// Installs what the lock file names, if that is not what is installed, and has Vite write to `dist`.
pub fn build(web: &Path, dist: &Path) -> Result<(), String> {
    let version = Command::new(NPM).arg("--version").stderr(Stdio::null()).output();
    if !version.is_ok_and(|out| out.status.success()) {
        return Err("npm was not found; install Node 20.19 or newer (it brings npm) and build again".to_owned());
    }
    // In `gen`, which is not watched: `npm ci` would delete a lock in node_modules.
    let folder = web.join("gen");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let lock = File::create(folder.join("build.lock")).map_err(|e| format!("web/gen/build.lock: {e}"))?;
    lock.lock().map_err(|e| format!("web/gen/build.lock cannot be locked: {e}"))?;

    let wanted =
        fs::read_to_string(web.join("package-lock.json")).map_err(|e| format!("web/package-lock.json: {e}"))?;
    let stamp = web.join("node_modules/.jointbench-lock");
    if fs::read_to_string(&stamp).ok().as_ref() != Some(&wanted) {
        npm(web, &["ci", "--no-audit", "--no-fund"])?;
        fs::write(&stamp, &wanted).map_err(|e| format!("{}: {e}", stamp.display()))?;
    }
    let out_dir = dist.to_str().ok_or("OUT_DIR is not valid UTF-8")?;
    npm(web, &["run", "build", "--", "--outDir", out_dir, "--emptyOutDir", "--logLevel", "warn"])
}

fn npm(web: &Path, arguments: &[&str]) -> Result<(), String> {
    let out = Command::new(NPM)
        .args(arguments)
        .current_dir(web)
        .stdin(Stdio::null())
        .output()
        .map_err(|e| format!("npm {}: {e}", arguments[0]))?;
    if out.status.success() {
        return Ok(());
    }
    let said = [out.stdout, out.stderr].concat();
    let said = String::from_utf8_lossy(&said);
    let last: Vec<&str> = said.lines().rev().filter(|line| !line.trim().is_empty()).take(12).collect();
    let last: Vec<&str> = last.into_iter().rev().collect();
    Err(format!("`npm {}` in web/ ended with {}:\n{}", arguments.join(" "), out.status, last.join("\n")))
}
