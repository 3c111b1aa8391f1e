//! Traffic of a wire as text, to read, send and replay. Each line is one piece.
//!
//! ```text
//! # joint on /dev/ttyUSB0
//! # opened at 1764149549.767296 s of Unix time
//! 0.000012 > 66 20 30 2A 31 31 38 0A
//! 0.000431 < 31 2E 30 30
//! 3.100000 ! the port is lost
//! ```
//!
//! Seconds since the link was opened; `>` to the instrument, `<` from it. The second line relates them to other clocks.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// What happened on a wire.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event {
    /// Bytes to the instrument.
    Sent(Vec<u8>),
    /// Bytes from the instrument.
    Received(Vec<u8>),
    /// The port was lost.
    Lost,
}

/// A recorded conversation. Consecutive pieces in one direction may have been split differently on the wire.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Traffic {
    /// Each event with the time since the link was opened (s).
    pub events: Vec<(f64, Event)>,
}

/// A line of a record that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line} of the traffic: `{text}`: expected seconds, `>`, `<` or `!`, and bytes in hexadecimal")]
pub struct TrafficError {
    /// Counted from 1.
    pub line: usize,
    /// The line, at most 80 characters.
    pub text: String,
}

impl Traffic {
    /// Reads a record in the format of this module.
    pub fn parse(text: &str) -> Result<Self, TrafficError> {
        let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
        let events = lines.map(|(number, line)| {
            event(line).ok_or_else(|| TrafficError { line: number + 1, text: line.chars().take(80).collect() })
        });
        Ok(Self { events: events.collect::<Result<_, _>>()? })
    }
}

fn event(line: &str) -> Option<(f64, Event)> {
    let mut words = line.split_ascii_whitespace();
    let at_s = words.next()?.parse::<f64>().ok().filter(|at_s| at_s.is_finite() && *at_s >= 0.0)?;
    let direction = words.next()?;
    let mut bytes = || words.by_ref().map(|word| u8::from_str_radix(word, 16).ok()).collect::<Option<Vec<u8>>>();
    let event = match direction {
        ">" => Event::Sent(bytes()?),
        "<" => Event::Received(bytes()?),
        "!" => Event::Lost,
        _ => return None,
    };
    Some((at_s, event))
}

/// Records the traffic of a link. A full disk ends the record, never the measurement.
pub struct Recorder {
    file: Option<File>,
    opened: Instant,
}

impl Recorder {
    /// Starts a new file: an existing record is replaced.
    pub fn create(path: &Path, instrument: &str, address: &str) -> io::Result<Self> {
        let mut file = File::create(path)?;
        let opened = Instant::now();
        let unix_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64());
        write!(file, "# {instrument} on {address}\n# opened at {unix_s:.6} s of Unix time\n")?;
        Ok(Self { file: Some(file), opened })
    }

    /// Records bytes to the instrument.
    pub fn sent(&mut self, bytes: &[u8]) {
        self.write('>', bytes);
    }

    /// Records bytes from the instrument.
    pub fn received(&mut self, bytes: &[u8]) {
        if !bytes.is_empty() {
            self.write('<', bytes);
        }
    }

    /// Records the loss of the port.
    pub fn lost(&mut self) {
        self.line(&format!("{:.6} ! the port is lost\n", self.opened.elapsed().as_secs_f64()));
    }

    fn write(&mut self, direction: char, bytes: &[u8]) {
        let mut line = format!("{:.6} {direction}", self.opened.elapsed().as_secs_f64());
        for byte in bytes {
            line.push_str(&format!(" {byte:02X}"));
        }
        line.push('\n');
        self.line(&line);
    }

    fn line(&mut self, line: &str) {
        if let Some(file) = &mut self.file
            && let Err(error) = file.write_all(line.as_bytes())
        {
            tracing::warn!(%error, "the record of the traffic ends here");
            self.file = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let folder = std::env::temp_dir().join(format!("jointbench-traffic-{}", std::process::id()));
        let mut recorder = Recorder::create(&folder, "joint", "/dev/ttyUSB0").unwrap();
        recorder.sent(b"f 0\n");
        recorder.received(b"");
        recorder.received(&[0x00, 0x02, 0xFF]);
        recorder.lost();
        let text = std::fs::read_to_string(&folder).unwrap();
        std::fs::remove_file(&folder).unwrap();
        let events: Vec<Event> = Traffic::parse(&text).unwrap().events.into_iter().map(|(_, event)| event).collect();
        assert_eq!(events, [Event::Sent(b"f 0\n".into()), Event::Received(vec![0x00, 0x02, 0xFF]), Event::Lost]);
    }

    #[test]
    fn a_mistake_is_named_at_its_line() {
        for line in ["0.1 > 6G", "0.1 = 00", "x > 00", "-1 > 00", "nan < 00", "0.1 > 100", "0.1"] {
            let error = Traffic::parse(&format!("# joint\n0.0 > 66\n\n{line}\n")).unwrap_err();
            assert_eq!((error.line, error.text.as_str()), (4, line));
        }
    }
}
