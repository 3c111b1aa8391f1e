//! This program itself: parts of the daemon run as processes of their own, from the same file.

use std::path::PathBuf;

/// The file of the program that runs now. On Linux the name still leads to it after an update has replaced the file, so
/// that a daemon never starts parts of another version.
pub fn own() -> PathBuf {
    if cfg!(target_os = "linux") {
        return PathBuf::from("/proc/self/exe");
    }
    // Where the system does not tell it, the search path may.
    std::env::current_exe().unwrap_or_else(|_| PathBuf::from("jointbench"))
}
