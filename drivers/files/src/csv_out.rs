//! CSV out: the shortest decimal that reads back as the same double.

use jointbench_instrument::Trace;
use std::io::{self, Write};

/// Bytes collected before they are handed on.
const CHUNK: usize = 1 << 16;

/// Writes the rows with a line of names. The facts ([`crate::meta_json`]) go into a file beside it.
pub fn write_csv(mut out: impl Write, trace: &Trace) -> io::Result<()> {
    let names: Vec<String> = trace.channels().iter().map(|channel| quoted(&channel.name)).collect();
    let mut text = names.join(",").into_bytes();
    text.push(b'\n');
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
            out.write_all(&text)?;
            text.clear();
        }
    }
    out.write_all(&text)
}

fn quoted(name: &str) -> String {
    match name.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.to_owned(),
    }
}
