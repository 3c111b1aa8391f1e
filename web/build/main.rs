//! Builds the dashboard once for each change of its sources and leaves the files in `$OUT_DIR/dist`.
//!
//! Assets live in a crate of their own because `rerun-if-changed` is crate-wide. Nothing that the build writes
//! (`node_modules`, `gen`) is watched, so that a build does not set off the next.

mod npm;

use std::path::{Path, PathBuf};
use std::{env, fs};

const WATCHED: [&str; 8] =
    ["app", "public", "build", "index.html", "package.json", "package-lock.json", "vite.config.ts", "svelte.config.js"];

fn main() {
    for path in WATCHED {
        println!("cargo::rerun-if-changed={path}");
    }
    println!("cargo::rerun-if-env-changed=JB_WEB_DIST");
    let web = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR"));
    let dist = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR")).join("dist");
    let _ = fs::remove_dir_all(&dist);
    fs::create_dir_all(&dist).expect("OUT_DIR is writable");

    let made = match env::var_os("JB_WEB_DIST") {
        Some(given) if given.is_empty() => {
            Err("the build was told to leave the dashboard out (JB_WEB_DIST is empty)".to_owned())
        }
        Some(given) => copy(Path::new(&given), &dist).map_err(|e| format!("JB_WEB_DIST={}: {e}", given.display())),
        None => npm::build(&web, &dist),
    };
    if let Err(why) = &made {
        println!("cargo::warning=no dashboard in this build: {}", why.replace('\n', " "));
        explain(&dist, why);
        // A file that is never there: the next build tries again.
        println!("cargo::rerun-if-changed=gen/never");
    }
    println!("cargo::rustc-env=JB_WEB_MISSING={}", made.err().unwrap_or_default().replace('\n', " "));
}

/// The daemon and its API work without the dashboard; its place is taken by a page that says how to get it.
fn explain(dist: &Path, why: &str) {
    let why = why.replace('&', "&amp;").replace('<', "&lt;");
    let page = include_str!("missing.html").replace("{{why}}", &why);
    fs::write(dist.join("index.html"), page).expect("OUT_DIR is writable");
}

fn copy(from: &Path, to: &Path) -> std::io::Result<()> {
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            fs::create_dir_all(&target)?;
            copy(&entry.path(), &target)?;
        } else {
            fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}
