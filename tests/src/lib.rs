//! What the tests and the fault suite share: the program as a user starts it, a bench whose server, worker, disk and clients
//! fail on purpose, and what must hold afterwards.

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

/// The workspace.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the workspace root")
}
