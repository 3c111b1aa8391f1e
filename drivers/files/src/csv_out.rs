//! Exports CSV with the shortest decimal that reads back as the same double.

use jointbench_instrument::{Channel, Trace};
use std::io::{self, Write};

/// Buffer size before data is written.
const CHUNK: usize = 1 << 16;

/// Writes the rows after a line of names. The facts ([`crate::meta_json`]) are a separate file.
pub fn write_csv(out: impl Write, trace: &Trace) -> io::Result<()> {
    let mut csv = CsvWriter::new(out, trace.channels());
    csv.write(trace)?;
    csv.finish()
}

/// Writes a CSV block by block.
pub struct CsvWriter<W> {
    out: W,
    text: Vec<u8>,
}

impl<W: Write> CsvWriter<W> {
    /// `channels` are the same for every block.
    pub fn new(out: W, channels: &[Channel]) -> Self {
        let names: Vec<String> = channels.iter().map(|channel| quoted(&channel.name)).collect();
        let mut text = names.join(",").into_bytes();
        text.push(b'\n');
        Self { out, text }
    }

    pub fn write(&mut self, trace: &Trace) -> io::Result<()> {
        let Self { out, text } = self;
        let mut digits = zmij::Buffer::new();
        for row in 0..trace.len() {
            for (place, column) in trace.columns().iter().enumerate() {
                if place > 0 {
                    text.push(b',');
                }
                let number = digits.format(column[row]);
                text.extend_from_slice(number.strip_suffix(".0").unwrap_or(number).as_bytes());
            }
            text.push(b'\n');
            if text.len() > CHUNK {
                out.write_all(text)?;
                text.clear();
            }
        }
        Ok(())
    }

    pub fn finish(mut self) -> io::Result<()> {
        self.out.write_all(&self.text)?;
        self.out.flush()
    }
}

fn quoted(name: &str) -> String {
    match name.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.to_owned(),
    }
}
