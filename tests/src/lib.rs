//! Shared by the tests and the fault suite: the real program, a bench with faults of its server, worker, disk and
//! clients, and the checks afterwards.

pub mod client;
pub mod deaths;
pub mod history;
pub mod lab;
pub mod machine;
pub mod outcome;
pub mod presses;
pub mod program;
pub mod stops;
pub mod trouble;
pub mod wire;

use std::path::PathBuf;

/// Root folder of the workspace.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the workspace root")
}
