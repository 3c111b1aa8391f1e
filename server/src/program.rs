//! This program itself: parts of the daemon run as processes of their own, from the same file.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use tracing::level_filters::LevelFilter;

/// The file of the program that runs now. On Linux the name still leads to it after an update has replaced the file, so
/// that a daemon never starts parts of another version.
pub fn own() -> PathBuf {
    if cfg!(target_os = "linux") {
        return PathBuf::from("/proc/self/exe");
    }
    // Where the system does not tell it, the search path may.
    std::env::current_exe().unwrap_or_else(|_| PathBuf::from("jointbench"))
}

/// The variables that tokens come in.
pub const TOKENS: [&str; 2] = ["JOINTBENCH_TOKEN", "JOINTBENCH_READ_TOKEN"];

static LOG_FORM: OnceLock<&'static str> = OnceLock::new();

/// The form of the log, which the parts write in too.
pub fn set_log_form(form: &'static str) {
    LOG_FORM.get_or_init(|| form);
}

/// A part of the daemon, as a process of its own: what it tells in its log is what this process tells.
pub fn part(program: &Path, name: &str) -> Command {
    let mut command = Command::new(program);
    command.arg(name);
    #[cfg(unix)]
    {
        // A list of processes shows the name, and not the way that leads to the file.
        use std::os::unix::process::CommandExt;
        command.arg0("jointbench");
    }
    // They open no door.
    for variable in TOKENS {
        command.env_remove(variable);
    }
    if let Some(form) = LOG_FORM.get() {
        command.args(["--log", form]);
    }
    if std::env::var_os("RUST_LOG").is_none() {
        command.env("RUST_LOG", LevelFilter::current().to_string());
    }
    command
}
