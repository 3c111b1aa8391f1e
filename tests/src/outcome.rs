//! Results as a table.

use std::fmt::Write;
use std::time::Duration;

/// Attempts and results, summed over scenarios.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outcome {
    pub name: String,
    pub faults: usize,
    pub acknowledged: usize,
    /// Acknowledged and missing.
    pub lost: usize,
    /// More than one occurrence.
    pub doubled: usize,
    /// Neither complete nor absent.
    pub half_done: usize,
    pub slowest_stop: Option<Duration>,
    /// In control ticks.
    pub longest_silence: Option<f64>,
    /// Longest stall of an idle thread: the machine stalls the daemon's threads in the same way.
    pub machine_stall: Option<Duration>,
    /// Broken guarantees, as sentences.
    pub broken: Vec<String>,
}

impl Outcome {
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    pub fn lost(&mut self, what: String) {
        self.lost += 1;
        self.broken.push(format!("lost: {what}"));
    }

    pub fn doubled(&mut self, what: String) {
        self.doubled += 1;
        self.broken.push(format!("duplicated: {what}"));
    }

    pub fn half_done(&mut self, what: String) {
        self.half_done += 1;
        self.broken.push(format!("incomplete: {what}"));
    }

    pub fn stopped_after(&mut self, latency: Duration) {
        self.slowest_stop = Some(self.slowest_stop.unwrap_or_default().max(latency));
    }

    pub fn silent_for(&mut self, ticks: f64) {
        self.longest_silence = Some(self.longest_silence.unwrap_or_default().max(ticks));
    }

    pub fn stalled_for(&mut self, stall: Duration) {
        self.machine_stall = Some(self.machine_stall.unwrap_or_default().max(stall));
    }

    /// Whether all guarantees were kept.
    pub fn holds(&self) -> bool {
        self.broken.is_empty()
    }
}

/// As Markdown, followed by the broken guarantees.
pub fn table(outcomes: &[Outcome]) -> String {
    let mut text = String::from(
        "| scenario | faults | acknowledged | lost | duplicated | incomplete | slowest stop | longest control pause | \
         lateness of a sleeping thread |\n\
         | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
    );
    for one in outcomes {
        let ms =
            |time: Option<Duration>| time.map_or_else(String::new, |it| format!("{:.1} ms", 1e3 * it.as_secs_f64()));
        let (stop, stall) = (ms(one.slowest_stop), ms(one.machine_stall));
        let silence = one.longest_silence.map_or_else(String::new, |ticks| format!("{ticks:.1} ticks"));
        let Outcome { name, faults, acknowledged, lost, doubled, half_done, .. } = one;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {name} | {faults} | {acknowledged} | {lost} | {doubled} | {half_done} | {stop} | {silence} | {stall} |"
        );
    }
    for one in outcomes {
        for broken in &one.broken {
            let _ = writeln!(text, "{}: {broken}", one.name);
        }
    }
    text
}
