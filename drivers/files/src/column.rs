//! A column as read from the file, before it is known whether it is needed.

use crate::text::{Content, Shape};

/// One column of a file.
#[derive(Debug, Clone, Default)]
pub struct Column {
    /// Its name in the file or a generated name; later its name in the run table.
    pub name: String,
    /// Its name in the file.
    pub source: String,
    /// Its unit from a line of units in the file.
    pub unit: Option<String>,
    pub content: Content,
    /// Its type in a columnar file, if it is not numeric; the values are not read then.
    pub other_type: Option<String>,
    /// A time without a unit: its values or the user must determine the unit.
    pub is_unit_open: bool,
    /// NaN for a cell without a number.
    pub values: Vec<f64>,
    pub found: Found,
    /// The first cells, for display.
    pub first: Vec<String>,
}

/// A cell with its position.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Row of the table, from 0.
    pub row: usize,
    pub text: String,
}

/// Observations while a column is read.
#[derive(Debug, Clone, Default)]
pub struct Found {
    /// Cells that are neither a number nor empty: the first of them, and all their rows.
    pub wrong: Vec<Cell>,
    pub wrong_rows: Vec<usize>,
    pub missing: usize,
    pub first_missing: Option<Cell>,
    pub truths: usize,
    pub numbers: usize,
    /// The first number whose thousands separator could be a decimal sign: 1.220 in a table with decimal commas.
    pub doubtful: Option<Cell>,
    /// The first number whose decimal sign could be a thousands separator: 1.220 in a table with decimal points.
    pub three_decimals: Option<Cell>,
    /// At least one number is grouped without ambiguity.
    pub is_grouped: bool,
    /// At least one number has decimals without ambiguity.
    pub is_decimal: bool,
    /// It contains whole numbers of more than two digits.
    pub has_hundreds: bool,
}

/// Cells that a note shows as examples.
const EXAMPLES: usize = 6;

impl Found {
    pub fn wrong(&mut self, row: usize, cell: &[u8]) {
        if self.wrong.len() < EXAMPLES {
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

    /// `later`: observations of subsequent rows, whose numbers start at 0.
    fn append(&mut self, later: Found, rows: usize) {
        let moved = |cell: Cell| Cell { row: cell.row + rows, ..cell };
        self.wrong.extend(later.wrong.into_iter().map(moved));
        self.wrong.truncate(EXAMPLES);
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

/// The part of a cell that a message shows.
fn text_of(cell: &[u8]) -> String {
    const SHOWN_BYTES: usize = 200;
    String::from_utf8_lossy(&cell[..cell.len().min(SHOWN_BYTES)]).into_owned()
}

impl Column {
    pub fn new(name: impl Into<String>, values: Vec<f64>) -> Self {
        let found = Found { numbers: values.len(), ..Found::default() };
        Self { name: name.into(), values, found, ..Self::default() }
    }

    /// Appends the values of subsequent rows after `rows` existing rows.
    pub fn append(&mut self, rows: usize, values: &[f64], found: Found) {
        self.values.extend_from_slice(values);
        self.found.append(found, rows);
    }

    /// Removes all rows but these, in ascending order.
    pub fn keep(&mut self, kept: &[usize]) {
        if self.values.is_empty() {
            return;
        }
        let place = |row: usize| kept.binary_search(&row).ok();
        let moved = |cell: Cell| place(cell.row).map(|row| Cell { row, ..cell });
        let found = &mut self.found;
        found.wrong = std::mem::take(&mut found.wrong).into_iter().filter_map(moved).collect();
        found.wrong_rows = found.wrong_rows.iter().filter_map(|row| place(*row)).collect();
        for cell in [&mut found.first_missing, &mut found.doubtful, &mut found.three_decimals] {
            *cell = cell.take().and_then(moved);
        }
        self.values = kept.iter().map(|row| self.values[*row]).collect();
        let empty = self.values.iter().filter(|value| value.is_nan()).count();
        found.missing = empty.saturating_sub(found.wrong_rows.len());
        found.numbers = (self.values.len() - empty).saturating_sub(found.truths);
    }

    /// Treats cells of this value as empty.
    pub fn empty(&mut self, code: f64) {
        for (row, value) in self.values.iter_mut().enumerate().filter(|(_, value)| **value == code) {
            *value = f64::NAN;
            self.found.missing += 1;
            self.found.numbers = self.found.numbers.saturating_sub(1);
            self.found.first_missing.get_or_insert_with(|| Cell { row, text: String::new() });
        }
    }

    /// The column has no use for a model.
    pub fn is_words(&self) -> bool {
        self.content == Content::Words || self.found.wrong_rows.len() > self.found.numbers + self.found.truths
    }
}
