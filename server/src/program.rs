//! This executable: parts of the daemon run as separate processes of the same file.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use tracing::level_filters::LevelFilter;

/// Path of the running executable. On Linux it remains valid after an update has replaced the file, so that a daemon
/// does not start parts of another version.
pub fn path() -> PathBuf {
    if cfg!(target_os = "linux") {
        return PathBuf::from("/proc/self/exe");
    }
    // If the system does not provide the path, use the search path.
    std::env::current_exe().unwrap_or_else(|_| PathBuf::from("jointbench"))
}

/// Environment variables of the tokens.
pub const TOKENS: [&str; 2] = ["JOINTBENCH_TOKEN", "JOINTBENCH_READ_TOKEN"];

static LOG_FORM: OnceLock<&'static str> = OnceLock::new();

/// Sets the log format, which the separate processes also use.
pub fn set_log_form(form: &'static str) {
    LOG_FORM.get_or_init(|| form);
}

/// A part of the daemon as a separate process, with the log settings of this process.
pub fn part(program: &Path, name: &str) -> Command {
    let mut command = Command::new(program);
    command.arg(name);
    #[cfg(unix)]
    {
        // A process list shows this name, not the path of the executable.
        use std::os::unix::process::CommandExt;
        command.arg0("jointbench");
    }
    // These processes need no tokens.
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
