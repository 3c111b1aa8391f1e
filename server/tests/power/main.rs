//! No acknowledged data is lost if the disk fails. A campaign runs on a disk that fails, or loses power, at its n-th
//! operation. Then the store is opened on an intact disk. The same with too little memory for SQLite.
//!
//! `disk.c` simulates the disk. The tests use a sample of the operations; `JOINTBENCH_EVERY_FAILURE=1` uses all.

#![cfg(target_os = "linux")]

mod campaign;

use campaign::{Acknowledged, FOLDER, LIMIT, check};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// Number of tested operations for each kind of failure.
const TRIES: usize = 12;
const SEEDS: [&str; 2] = ["1", "2"];

#[test]
fn nothing_acknowledged_is_lost_when_the_disk_fails() {
    let disk = Disk::build();
    for does in ["eio", "eio-forever", "enospc", "enospc-forever", "short"] {
        for at in disk.operations() {
            disk.try_one(&[("DISK_DOES", does), ("DISK_AT", &at.to_string())]);
        }
    }
}

#[test]
fn nothing_acknowledged_is_lost_when_the_power_fails() {
    let disk = Disk::build();
    for seed in SEEDS {
        for at in disk.operations() {
            disk.try_one(&[("DISK_DOES", "cut"), ("DISK_AT", &at.to_string()), ("DISK_SEED", seed)]);
        }
    }
}

/// SQLite counts its allocations: beyond the limit each allocation fails.
#[test]
fn nothing_acknowledged_is_lost_when_memory_runs_out() {
    let disk = Disk::build();
    let tries = if every() { 100 } else { TRIES / 2 };
    let mut acknowledged = 0;
    for one in 0..tries {
        // From a limit with immediate failure to a sufficient limit.
        let kib = 250.0 * 40_f64.powf(one as f64 / (tries - 1) as f64);
        acknowledged = disk.try_one(&[(LIMIT, &format!("{}", kib as u64 * 1024))]);
    }
    assert!(acknowledged > 5, "the largest limit lets a campaign through");
}

fn every() -> bool {
    std::env::var_os("JOINTBENCH_EVERY_FAILURE").is_some()
}

struct Disk {
    /// Folder of the library and of a store without runs.
    place: TempDir,
    library: PathBuf,
    /// Number of operations of a campaign without failure.
    operations: usize,
}

impl Disk {
    fn build() -> Disk {
        let place = tempfile::tempdir().unwrap();
        let (library, count) = (place.path().join("disk.so"), place.path().join("count"));
        let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/power/disk.c");
        let built = Command::new("cc")
            .args(["-Wall", "-Wextra", "-Werror", "-O1", "-shared", "-fPIC", "-o"])
            .args([library.as_os_str(), source.as_ref(), "-ldl".as_ref(), "-lpthread".as_ref()])
            .status();
        assert!(built.expect("a C compiler is at hand").success());
        campaign::make_empty(&place.path().join("empty"));
        let mut disk = Disk { place, library, operations: 0 };
        let acknowledged = disk.try_one(&[("DISK_COUNT", count.to_str().unwrap())]);
        assert_eq!(acknowledged, campaign::STEPS, "a sound disk keeps the whole campaign");
        disk.operations = std::fs::read_to_string(count).unwrap().trim().parse().unwrap();
        assert!(disk.operations > 50, "{} operations", disk.operations);
        disk
    }

    fn operations(&self) -> impl Iterator<Item = usize> {
        let step = if every() { 1 } else { self.operations.div_ceil(TRIES) };
        (1..=self.operations).step_by(step)
    }

    /// Returns the number of acknowledged steps. All of them must be in the store.
    fn try_one(&self, settings: &[(&str, &str)]) -> usize {
        let folder = tempfile::tempdir_in(self.place.path()).unwrap();
        copy(&self.place.path().join("empty"), folder.path());
        let child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "campaign::runs_on_this_disk", "--ignored", "--nocapture"])
            .env("LD_PRELOAD", &self.library)
            .env("DISK_FOLDER", folder.path())
            .env(FOLDER, folder.path())
            .envs(settings.iter().copied())
            .stderr(Stdio::null())
            .output()
            .unwrap();
        let acknowledged = Acknowledged::read(&String::from_utf8_lossy(&child.stdout));
        check(folder.path(), &acknowledged, &format!("{settings:?}"));
        acknowledged.steps
    }
}

fn copy(from: &Path, to: &Path) {
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
    }
}
