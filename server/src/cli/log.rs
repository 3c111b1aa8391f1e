//! Logs go to standard error, so that standard output contains only results.

use clap::ValueEnum;
use std::io::{IsTerminal, stderr};
use tracing_subscriber::EnvFilter;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LogForm {
    /// One line for a person.
    Text,
    /// One JSON object a line.
    Json,
}

/// `RUST_LOG` selects the log messages; the default is everything from `level` on.
pub fn start(form: LogForm, level: &str) {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(level));
    let builder = tracing_subscriber::fmt().with_env_filter(filter).with_writer(stderr);
    crate::program::set_log_form(match form {
        LogForm::Text => "text",
        LogForm::Json => "json",
    });
    match form {
        LogForm::Text => builder.with_target(false).with_ansi(stderr().is_terminal()).init(),
        LogForm::Json => builder.json().flatten_event(true).init(),
    }
}
