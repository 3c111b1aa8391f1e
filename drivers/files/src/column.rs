//! A column as it was read, before anybody knows whether it is needed.

use crate::text::{Content, Shape};

/// One column of a file.
#[derive(Debug, Clone, Default)]
pub struct Column {
    /// Its name: in the file, or the one that stands for it; later that in the run table.
    pub name: String,
    /// Its name in the file.
    pub source: String,
    /// Its unit as the file states it, in a line of units.
    pub unit: Option<String>,
    pub content: Content,
    /// What it holds in a columnar file, where that is no number; its values were not read.
    pub other_type: Option<String>,
    /// A time without a unit: its values decide, or a person.
    pub is_unit_open: bool,
    /// Not a number where a cell held none.
    pub values: Vec<f64>,
    pub found: Found,
    /// The first cells, for people.
    pub first: Vec<String>,
}

/// A cell and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Row of the table, from 0.
    pub row: usize,
    pub text: String,
}

/// What came up while a column was read.
#[derive(Debug, Clone, Default)]
pub struct Found {
    /// Cells that hold neither a number nor nothing; the first of them, and all their rows.
    pub wrong: Vec<Cell>,
    pub wrong_rows: Vec<usize>,
    pub missing: usize,
    pub first_missing: Option<Cell>,
    pub truths: usize,
    pub numbers: usize,
    /// The first number in which the sign of thousands could be that of decimals: 1.220 among decimal commas.
    pub doubtful: Option<Cell>,
    /// The first number in which the sign of decimals could be that of thousands: 1.220 among decimal points.
    pub three_decimals: Option<Cell>,
    /// One of its numbers is grouped, without a doubt.
    pub is_grouped: bool,
    /// One of its numbers has decimals, without a doubt.
    pub is_decimal: bool,
    /// It holds whole numbers of more than two digits.
    pub has_hundreds: bool,
}

/// Cells that a note shows as examples.
const TOLD: usize = 6;

impl Found {
    pub fn wrong(&mut self, row: usize, cell: &[u8]) {
        if self.wrong.len() < TOLD {
            self.wrong.push(Cell { row, text: text_of(cell) });
        }
        self.wrong_rows.push(row);
    }

    pub fn missing(&mut self, row: usize, cell: &[u8]) {
        self.missing += 1;
        self.first_missing.get_or_insert_with(|| Cell { row, text: text_of(cell) });
    }

    pub fn number(&mut self, row: usize, cell: &[u8], shape: Shape) {
        match shape {
            Shape::Doubtful => drop(self.doubtful.get_or_insert_with(|| Cell { row, text: text_of(cell) })),
            Shape::Grouped => self.is_grouped = true,
            Shape::Plain => {}
        }
    }

    pub fn three_decimals(&mut self, row: usize, cell: &[u8]) {
        self.three_decimals.get_or_insert_with(|| Cell { row, text: text_of(cell) });
    }

    /// `later`: of rows that come behind, whose numbers begin at 0.
    fn append(&mut self, later: Found, rows: usize) {
        let moved = |cell: Cell| Cell { row: cell.row + rows, ..cell };
        self.wrong.extend(later.wrong.into_iter().map(moved));
        self.wrong.truncate(TOLD);
        self.wrong_rows.extend(later.wrong_rows.into_iter().map(|row| row + rows));
        self.missing += later.missing;
        self.first_missing = self.first_missing.take().or(later.first_missing.map(moved));
        self.truths += later.truths;
        self.numbers += later.numbers;
        self.doubtful = self.doubtful.take().or(later.doubtful.map(moved));
        self.three_decimals = self.three_decimals.take().or(later.three_decimals.map(moved));
        self.is_grouped |= later.is_grouped;
        self.is_decimal |= later.is_decimal;
        self.has_hundreds |= later.has_hundreds;
    }
}

/// As much of a cell as a message shows.
fn text_of(cell: &[u8]) -> String {
    const SHOWN_BYTES: usize = 200;
    String::from_utf8_lossy(&cell[..cell.len().min(SHOWN_BYTES)]).into_owned()
}

impl Column {
    pub fn new(name: impl Into<String>, values: Vec<f64>) -> Self {
        let found = Found { numbers: values.len(), ..Found::default() };
        Self { name: name.into(), values, found, ..Self::default() }
    }

    /// Adds the values of rows that come behind `rows` others.
    pub fn append(&mut self, rows: usize, values: &[f64], found: Found) {
        self.values.extend_from_slice(values);
        self.found.append(found, rows);
    }

    /// Without the rows from this one on.
    pub fn truncate(&mut self, rows: usize) {
        let found = &mut self.found;
        found.wrong.retain(|cell| cell.row < rows);
        let gone = found.wrong_rows.split_off(found.wrong_rows.partition_point(|row| *row < rows));
        let values = self.values.split_off(rows.min(self.values.len()));
        let empty = values.iter().filter(|value| value.is_nan()).count().saturating_sub(gone.len());
        found.missing = found.missing.saturating_sub(empty);
        found.first_missing = found.first_missing.take().filter(|cell| cell.row < rows);
        found.numbers = found.numbers.saturating_sub(values.len() - empty - gone.len());
    }

    /// Takes cells of this value as empty.
    pub fn empty(&mut self, code: f64) {
        for (row, value) in self.values.iter_mut().enumerate().filter(|(_, value)| **value == code) {
            *value = f64::NAN;
            self.found.missing += 1;
            self.found.numbers = self.found.numbers.saturating_sub(1);
            self.found.first_missing.get_or_insert_with(|| Cell { row, text: String::new() });
        }
    }

    /// Nothing for a model.
    pub fn is_words(&self) -> bool {
        self.content == Content::Words || self.found.wrong_rows.len() > self.found.numbers + self.found.truths
    }
}
