//! Exports MATLAB files in level 4 of the MAT format. MATLAB, Octave and SciPy have read it since 1990, and it suffices
//! for a table of doubles. Source: "MAT-File Format" (The MathWorks), chapter "Level 4 MAT-file format".

use crate::facts::meta_json;
use jointbench_instrument::{Channel, Meta, Trace};
use std::collections::HashSet;
use std::io::{self, BufWriter, Write};

/// Little-endian doubles, a full matrix.
const NUMBERS: i32 = 0;
/// Little-endian bytes, read as text.
const TEXT: i32 = 51;
/// MATLAB cuts longer names.
const LONGEST_NAME: usize = 63;
/// The variable with the facts.
const FACTS: &str = "meta_json";
/// Buffer size before data is written.
const CHUNK: usize = 1 << 16;

/// Writes one column vector per channel, and the facts as the text `meta_json`.
pub fn write_mat(out: impl Write, meta: &Meta, trace: &Trace) -> io::Result<()> {
    let mut mat = MatWriter::new(out);
    for (channel, column) in trace.channels().iter().zip(trace.columns()) {
        mat.begin(&channel.name, column.len())?;
        mat.values(column)?;
    }
    mat.finish(meta, trace.channels())
}

/// Writes a MAT file column by column.
pub struct MatWriter<W: Write> {
    out: BufWriter<W>,
    taken: HashSet<String>,
}

impl<W: Write> MatWriter<W> {
    pub fn new(out: W) -> Self {
        Self { out: BufWriter::with_capacity(CHUNK, out), taken: HashSet::from([FACTS.to_owned()]) }
    }

    /// Starts a column; `rows` values follow.
    pub fn begin(&mut self, name: &str, rows: usize) -> io::Result<()> {
        head(&mut self.out, NUMBERS, rows, 1, &free_name(name, &mut self.taken))
    }

    /// The next values of the current column.
    pub fn values(&mut self, values: &[f64]) -> io::Result<()> {
        values.iter().try_for_each(|value| self.out.write_all(&value.to_le_bytes()))
    }

    pub fn finish(mut self, meta: &Meta, channels: &[Channel]) -> io::Result<()> {
        let facts = meta_json(meta, channels);
        head(&mut self.out, TEXT, 1, facts.len(), FACTS)?;
        self.out.write_all(facts.as_bytes())?;
        self.out.flush()
    }
}

fn head(out: &mut impl Write, kind: i32, rows: usize, columns: usize, name: &str) -> io::Result<()> {
    let count = |count: usize| i32::try_from(count).map_err(|_| io::Error::other("too long for a MAT file"));
    for number in [kind, count(rows)?, count(columns)?, 0, count(name.len() + 1)?] {
        out.write_all(&number.to_le_bytes())?;
    }
    out.write_all(name.as_bytes())?;
    out.write_all(&[0])
}

/// A name of letters, digits and underscores that starts with a letter and is not used yet.
fn free_name(wanted: &str, taken: &mut HashSet<String>) -> String {
    let mut plain: String = wanted.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !plain.starts_with(|c: char| c.is_ascii_alphabetic()) {
        plain.insert(0, 'x');
    }
    plain.truncate(LONGEST_NAME);
    let mut name = plain.clone();
    let mut number = 2;
    while !taken.insert(name.clone()) {
        let end = format!("_{number}");
        name = plain[..plain.len().min(LONGEST_NAME - end.len())].to_owned() + &end;
        number += 1;
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_instrument::Channel;

    #[test]
    fn the_bytes_are_those_of_the_format() {
        let trace = Trace::from_columns(vec![Channel::new("t")], vec![vec![1.0, 2.5]]);
        let mut bytes = Vec::new();
        write_mat(&mut bytes, &Meta::default(), &trace).unwrap();
        let mut begin = Vec::new();
        for number in [0i32, 2, 1, 0, 2] {
            begin.extend(number.to_le_bytes());
        }
        begin.extend(b"t\0");
        begin.extend(1.0f64.to_le_bytes());
        begin.extend(2.5f64.to_le_bytes());
        begin.extend(51i32.to_le_bytes());
        assert_eq!(&bytes[..begin.len()], begin);
        assert!(bytes.ends_with(b"}") || bytes.ends_with(b"}\n"), "the facts are the last");
    }

    #[test]
    fn every_name_is_one_that_matlab_takes() {
        let mut taken = HashSet::new();
        let names = ["Iq (A)", "Iq [A]", "2nd", "meta_json"].map(|name| free_name(name, &mut taken));
        assert_eq!(names, ["Iq__A_", "Iq__A__2", "x2nd", "meta_json"]);
        let long = "a".repeat(80);
        assert_eq!(free_name(&long, &mut taken).len(), 63);
        assert!(free_name(&long, &mut taken).ends_with("a_2"));
    }
}
