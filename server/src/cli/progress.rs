//! Progress of a run: a bar on a terminal, plain lines otherwise.

use crate::view::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

const LINE_EVERY: Duration = Duration::from_secs(5);

pub struct RunProgress {
    bar: Option<ProgressBar>,
    printed_at: Option<Instant>,
    paused: bool,
}

impl RunProgress {
    pub fn begin() -> Self {
        let bar = stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("  [{bar:32}] {percent:>3} %  {msg}");
            ProgressBar::new(1000)
                .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("##-"))
        });
        Self { bar, printed_at: None, paused: false }
    }

    /// Printed once for each pause.
    pub fn paused(&mut self, run: i64) {
        let message = format!("paused: resume it with `jointbench resume {run}`");
        if let Some(bar) = &self.bar {
            bar.set_message(message);
        } else if !self.paused {
            eprintln!("  {message}");
        }
        self.paused = true;
    }

    pub fn show(&mut self, progress: &Progress) {
        if std::mem::take(&mut self.paused) {
            self.printed_at = None;
        }
        let at_most = if progress.at_most { "at most " } else { "" };
        let left = format!("{at_most}{:.0} s left", progress.remaining_s);
        let step = format!("step {}/{}", (progress.step + 1).min(progress.steps), progress.steps);
        if let Some(bar) = &self.bar {
            bar.set_position((1000.0 * progress.fraction) as u64);
            bar.set_message(format!("{left}  {step}  {}", progress.label));
        } else if self.printed_at.is_none_or(|printed_at| printed_at.elapsed() >= LINE_EVERY) {
            self.printed_at = Some(Instant::now());
            eprintln!("  {:>3.0} %  {left}  {step}  {}", 100.0 * progress.fraction, progress.label);
        }
    }

    pub fn end(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}
