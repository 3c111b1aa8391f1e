//! The rows of a text: each cell a number or another content.

use super::cell::{self, Decimal, Shape};
use super::content::Content;
use super::layout::Layout;
use super::line::{Separator, is_comment, spread};
use super::stamp;
use crate::Bounds;
use crate::column::Found;
use crate::error::FileFault;
use csv::ByteRecord;

/// How the cells of one column are read.
#[derive(Debug, Clone, Copy)]
pub struct Way {
    pub content: Content,
    pub decimal: Decimal,
    /// The column is not needed; its content is ignored.
    pub is_left: bool,
}

/// Parameters for reading rows, constant for all pieces.
pub struct Rows<'o> {
    pub separator: Separator,
    pub ways: Vec<Way>,
    pub names: Vec<String>,
    /// Words for an empty cell.
    pub missing: &'o [String],
    pub bounds: &'o Bounds,
}

/// Content of a piece of the text. Rows count from 0, lines from 1, both within the piece.
#[derive(Debug, Default)]
pub struct Part {
    pub columns: Vec<(Vec<f64>, Found)>,
    pub rows: usize,
    pub lines: Lines,
    /// Number of line ends in the piece.
    pub ends: u64,
    /// Rows with a different number of cells: line, cells, and whether the row starts with a number.
    pub odd: Vec<(u64, usize, bool)>,
    pub comments: usize,
    /// Rows before which the line of names is repeated.
    pub named_again: Vec<usize>,
    /// The last row is incomplete: it has no line end, and it or its last cell is shorter than all others.
    pub is_cut: bool,
    pub refused: Option<(u64, usize, FileFault)>,
}

/// The start lines of rows. Stored only where a row does not start on the line after the row before.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Lines {
    leaps: Vec<(usize, u64)>,
    next: u64,
}

impl Lines {
    fn push(&mut self, row: usize, line: u64) {
        if self.leaps.is_empty() || line != self.next {
            self.leaps.push((row, line));
        }
        self.next = line + 1;
    }

    pub fn append(&mut self, later: Lines, rows: usize, lines: u64) {
        self.leaps.extend(later.leaps.into_iter().map(|(row, line)| (row + rows, line + lines)));
    }

    /// The line of a row.
    pub fn of(&self, row: usize) -> Option<u64> {
        let at = self.leaps.partition_point(|(first, _)| *first <= row).checked_sub(1)?;
        let (first, line) = self.leaps[at];
        Some(line + (row - first) as u64)
    }
}

impl Layout {
    pub fn ways(&self) -> Vec<Way> {
        let way = |content| Way { content, decimal: self.decimal, is_left: content == Content::Empty };
        self.columns.iter().map(|column| way(column.content)).collect()
    }
}

/// With this many rows, a shortest last cell at the end is not a coincidence.
const MANY: usize = 20;

impl Rows<'_> {
    /// `is_last`: the last row needs no line end.
    pub fn part(&self, text: &[u8], is_last: bool) -> Part {
        let mut even = Vec::new();
        let text = match self.separator {
            Separator::Blanks => {
                spread(text, &mut even);
                &even
            }
            Separator::Sign(_) => text,
        };
        let mut part = Part { ends: text.iter().filter(|byte| **byte == b'\n').count() as u64, ..Part::default() };
        let guess = text.len() / (self.ways.len().max(1) * 6);
        part.columns = self.ways.iter().map(|way| (self.room(way, guess), Found::default())).collect();
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(self.separator.sign())
            .has_headers(false)
            .flexible(true)
            .from_reader(text);
        let mut record = ByteRecord::new();
        let mut shortest = usize::MAX;
        // Reading from memory with flexible widths cannot fail.
        while reader.read_byte_record(&mut record).unwrap_or(false) {
            let is_end = is_last && reader.position().byte() == text.len() as u64 && !text.ends_with(b"\n");
            let length = record.iter().next_back().map_or(0, |cell| cell.trim_ascii().len());
            if is_end && part.rows >= MANY && length < shortest && self.fits(&record) {
                part.is_cut = true;
                break;
            }
            shortest = shortest.min(length);
            self.take(&record, text, is_end, &mut part);
            if part.refused.is_some() || part.rows > self.bounds.rows {
                break;
            }
        }
        part
    }

    fn room(&self, way: &Way, rows: usize) -> Vec<f64> {
        if way.is_left { Vec::new() } else { Vec::with_capacity(rows) }
    }

    fn take(&self, record: &ByteRecord, text: &[u8], is_end: bool, part: &mut Part) {
        let line = || line_of(text, record);
        if record.len() <= 1 && record.iter().all(|cell| cell.trim_ascii().is_empty()) {
            return;
        }
        let first = record.get(0).unwrap_or_default();
        if matches!(first.first(), Some(b'#' | b'%' | b'/')) && is_comment(first) {
            part.comments += 1;
            return;
        }
        if self.is_names(record) {
            part.named_again.push(part.rows);
            return;
        }
        if !self.fits(record) {
            match is_end && record.len() < self.ways.len() {
                true => part.is_cut = true,
                false => part.odd.push((line(), record.len(), cell::is_number(first))),
            }
            return;
        }
        let row = part.rows;
        for (place, way) in self.ways.iter().enumerate().filter(|(_, way)| !way.is_left) {
            let cell = record.get(place).unwrap_or_default();
            if let Err(fault) = self.bounds.check_cell(cell.len()) {
                part.refused = Some((line(), place, fault));
                return;
            }
            let (values, found) = &mut part.columns[place];
            values.push(way.read(cell, row, self.missing, found));
        }
        part.lines.push(row, line());
        part.rows += 1;
    }

    /// A repeated line of names, as a restarted logger writes it.
    fn is_names(&self, record: &ByteRecord) -> bool {
        let named = self.names.first().is_some_and(|name| !name.is_empty());
        let is_same = |(cell, name): (&[u8], &String)| cell.trim_ascii() == name.as_bytes();
        named && record.len() == self.names.len() && record.iter().zip(&self.names).all(is_same)
    }

    /// Surplus cells must be empty. Missing cells are allowed in empty columns and columns of words, such as a comment
    /// in a few rows.
    fn fits(&self, record: &ByteRecord) -> bool {
        let (found, expected) = (record.len(), self.ways.len());
        match found.cmp(&expected) {
            std::cmp::Ordering::Equal => true,
            std::cmp::Ordering::Greater => record.iter().skip(expected).all(|cell| cell.trim_ascii().is_empty()),
            std::cmp::Ordering::Less => {
                self.ways[found..].iter().all(|way| matches!(way.content, Content::Empty | Content::Words))
            }
        }
    }
}

impl Way {
    fn read(self, cell: &[u8], row: usize, missing: &[String], found: &mut Found) -> f64 {
        if let Content::Stamps(first) = self.content {
            if let Some(stamp) = stamp::parse(cell) {
                found.numbers += 1;
                return (i128::from(stamp.nanoseconds()) - i128::from(first.nanoseconds())) as f64 * 1e-9;
            }
        } else if let Some(value) = self.number(cell, row, found) {
            found.numbers += 1;
            return value;
        }
        match cell::truth(cell) {
            _ if cell::is_missing(cell) => found.missing(row, cell),
            Some(truth) => {
                found.truths += 1;
                return f64::from(u8::from(truth));
            }
            None if missing.iter().any(|word| cell.trim_ascii().eq_ignore_ascii_case(word.as_bytes())) => {
                found.missing(row, cell);
            }
            None => found.wrong(row, cell),
        }
        f64::NAN
    }

    fn number(self, cell: &[u8], row: usize, found: &mut Found) -> Option<f64> {
        if self.decimal == Decimal::Point
            && let Some(value) = cell::plain(cell)
        {
            if !found.is_decimal {
                self.weigh(cell, value, row, found);
            }
            return Some(value);
        }
        let (value, shape) = cell::number(cell, self.decimal)?;
        if shape == Shape::Plain && !found.is_decimal {
            self.weigh(cell, value, row, found);
        }
        found.number(row, cell, shape);
        Some(value)
    }

    /// Collects the evidence of a plain number for the decimal sign of its column.
    fn weigh(self, cell: &[u8], value: f64, row: usize, found: &mut Found) {
        match cell.contains(&self.decimal.sign()) {
            true if cell::could_be_grouped(cell, self.decimal.sign()) => {
                found.three_decimals(row, cell);
            }
            true => found.is_decimal = true,
            false => found.has_hundreds |= value.abs() >= 100.0,
        }
    }
}

fn line_of(text: &[u8], record: &ByteRecord) -> u64 {
    let Some(position) = record.position() else { return 1 };
    // The reader reports the position before empty lines; the record starts after them.
    let blank = text[position.byte() as usize..].iter().take_while(|byte| matches!(byte, b'\r' | b'\n'));
    position.line() + blank.filter(|byte| **byte == b'\n').count() as u64
}
