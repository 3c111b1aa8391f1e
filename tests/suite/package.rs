//! The Debian package of the tested program: its files, its service and its program. Skipped with a message where a tool
//! is missing.

use crate::browser::has;
use crate::house::root;
use crate::program::{jointbench, stderr};
use std::path::Path;
use std::process::Command;

/// Files that a user of the package relies on.
const FILES: [&str; 6] = [
    "usr/share/man/man1/jointbench-serve.1.gz",
    "usr/share/bash-completion/completions/jointbench",
    "usr/share/zsh/vendor-completions/_jointbench",
    "usr/share/fish/vendor_completions.d/jointbench.fish",
    "usr/lib/udev/rules.d/60-jointbench.rules",
    "usr/share/doc/jointbench/copyright",
];
const SERVICE: &str = "usr/lib/systemd/system/jointbench.service";

fn succeeds(command: &mut Command) {
    let output = command.output().expect("the command starts");
    assert!(output.status.success(), "{command:?}: {}", stderr(&output));
}

#[test]
fn the_debian_package_has_a_program_a_service_and_manuals() {
    if !["dpkg-deb", "objdump", "strip"].into_iter().all(has) {
        eprintln!("SKIPPED: dpkg-deb or binutils are not installed. The Debian package was NOT built.");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let installed = folder.path().join("installed");
    let mut build = Command::new(root().join("packaging/deb"));
    // Compression takes most of the time.
    build.arg(jointbench().get_program()).arg(folder.path()).env("DPKG_DEB_COMPRESSOR_TYPE", "none");
    succeeds(&mut build);
    let named = |entry: &std::fs::DirEntry| entry.path().extension().is_some_and(|ending| ending == "deb");
    let mut entries = std::fs::read_dir(folder.path()).expect("a folder").map_while(Result::ok);
    let package = entries.find(named).expect("a package").path();
    succeeds(Command::new("dpkg-deb").arg("--extract").arg(package).arg(&installed));
    for file in FILES {
        assert!(std::fs::metadata(installed.join(file)).is_ok_and(|found| found.len() > 0), "{file} is empty");
    }
    let program = installed.join("usr/bin/jointbench");
    succeeds(Command::new(&program).arg("check").arg(installed.join("etc/jointbench/bench.toml")));
    check_service(&installed, &program);
}

/// The unit with the path of the extracted program.
fn check_service(installed: &Path, program: &Path) {
    if !has("systemd-analyze") {
        eprintln!("SKIPPED: systemd-analyze is not installed. The service was NOT checked.");
        return;
    }
    let unit = std::fs::read_to_string(installed.join(SERVICE)).expect("a service");
    let placed = installed.join("jointbench.service");
    std::fs::write(&placed, unit.replace("/usr/bin/jointbench", &program.display().to_string())).expect("written");
    succeeds(Command::new("systemd-analyze").args(["verify", "--man=no"]).arg(placed));
}
