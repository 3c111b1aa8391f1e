//! A table as it is in the file, before names, units and values are checked.

use crate::column::Column;
use crate::error::{FileError, FileFault, Place, Wrong};
use crate::guess::unit_of;
use crate::naming::{Named, known};
use crate::note::{Note, counted, plural};
use crate::text::{Decimal, Lines};
use crate::{ProposedOption, ReadOptions};
use jointbench_instrument::{Kind, Meta};

/// A row with a different number of cells.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Odd {
    pub line: u64,
    pub cells: usize,
    /// It starts with a number, like a row with missing cells.
    pub is_row: bool,
}

/// Words in this many columns of one row are not codes for empty cells.
const SECOND_HEADER: usize = 2;
/// Largest number of lines below the rows.
const FOOTER_LINES: usize = 20;

#[derive(Debug, Default)]
pub(crate) struct RawTable {
    pub columns: Vec<Column>,
    pub rows: usize,
    /// A text file has lines; a columnar file has none.
    pub is_text: bool,
    pub lines: Lines,
    pub names_line: u64,
    pub odd: Vec<Odd>,
    pub comments: usize,
    /// Initial names for a text without a line of names.
    pub proposed_names: Option<String>,
    pub is_cut: bool,
    /// Rows before which the line of names is repeated.
    pub named_again: Vec<usize>,
    /// The remaining rows of the file, if some were omitted.
    pub places: Option<Vec<usize>>,
    pub omitted: usize,
    pub decimal: Decimal,
    pub meta: Option<Meta>,
    pub notes: Vec<Note>,
}

impl RawTable {
    pub fn of_text(columns: Vec<Column>) -> Self {
        Self { columns, is_text: true, names_line: 1, ..Self::default() }
    }

    pub fn place(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }

    pub fn names(&self) -> Vec<String> {
        self.columns.iter().map(|column| column.name.clone()).collect()
    }

    /// Position of a row: its line in a text, else its number from 1.
    pub fn located(&self, file: &str, row: usize) -> Place {
        let place = Place { file: file.to_owned(), ..Place::default() };
        let number = Some(self.number_of(row));
        match self.is_text {
            true => Place { line: number, ..place },
            false => Place { row: number, ..place },
        }
    }

    /// Line of a row in a text, else its number in the file from 1.
    pub fn number_of(&self, row: usize) -> u64 {
        let row = self.places.as_ref().map_or(row, |places| places[row]);
        if self.is_text { self.lines.of(row).unwrap_or_default() } else { row as u64 + 1 }
    }

    /// Omits all rows but these, in ascending order.
    pub fn keep(&mut self, kept: Vec<usize>) {
        self.columns.iter_mut().for_each(|column| column.keep(&kept));
        self.named_again.iter_mut().for_each(|row| *row = kept.partition_point(|place| place < row));
        self.rows = kept.len();
        self.places = Some(match self.places.take() {
            Some(places) => kept.into_iter().map(|row| places[row]).collect(),
            None => kept,
        });
    }

    /// Gives a unique name to columns with a missing or repeated name.
    pub fn name_all(&mut self) {
        match &self.proposed_names {
            None => self.leave_index(),
            Some(proposed) if self.columns.iter().any(|column| column.name.is_empty()) => {
                let message = "no line names the columns: they are called “column_1”, “column_2” and so on";
                self.notes.push(Note::with(message, ProposedOption::open("names", proposed)));
            }
            Some(_) => {}
        }
        let is_nameless = self.proposed_names.is_some();
        let mut taken: Vec<String> = Vec::new();
        for (place, column) in self.columns.iter_mut().enumerate() {
            if column.name.is_empty() {
                column.name = format!("column_{}", place + 1);
                if !is_nameless {
                    let message = format!("column {} has no name and is called “{}”", place + 1, column.name);
                    self.notes.push(Note::new(message));
                }
            }
            if taken.contains(&column.name) {
                let twice = column.name.clone();
                let more = (2..).map(|number| format!("{twice}_{number}")).find(|name| !taken.contains(name));
                column.name = more.unwrap_or_default();
                let message = format!(
                    "two columns are called “{twice}”: the first is taken, the other is called “{}”",
                    column.name
                );
                self.notes.push(Note::new(message));
            }
            column.source.clone_from(&column.name);
            taken.push(column.name.clone());
        }
    }

    /// Neither a line nor an option names a column.
    pub fn is_unnamed(&self, kind: Kind) -> bool {
        let is_named = |name: &str| name != "time_s" && self.place(name).is_some();
        self.proposed_names.is_some() && !known(kind).any(is_named)
    }

    /// Drops a first column without a name that counts the rows, as data frames write it.
    fn leave_index(&mut self) {
        let counts = |column: &Column| {
            let from = column.values.first().copied().unwrap_or(f64::NAN);
            let is_counted = |(row, value): (usize, &f64)| *value == from + row as f64;
            column.values.len() > 1 && column.values.iter().enumerate().all(is_counted)
        };
        let is_index = |column: &Column| matches!(column.name.as_str(), "" | "Unnamed: 0") && counts(column);
        if self.columns.len() > 1 && self.columns.first().is_some_and(is_index) {
            self.columns.remove(0);
            self.notes.push(Note::with(
                "the first column counts the rows and is omitted",
                ProposedOption::words("--names to keep it"),
            ));
        }
    }

    /// Drops a few lines after the last row, such as a mean or "End of file". They end the table.
    pub fn leave_footer(&mut self) {
        let begins_wrong = |row: usize| {
            let first = self.columns.iter().find(|column| !column.values.is_empty());
            first.is_some_and(|column| column.found.wrong_rows.binary_search(&row).is_ok())
        };
        let end = (0..self.rows).rev().find(|row| !begins_wrong(*row)).map_or(0, |row| row + 1);
        let Some(last) = end.checked_sub(1).and_then(|row| self.lines.of(row)) else { return };
        let below: Vec<&Odd> = self.odd.iter().filter(|odd| odd.line > last).collect();
        let count = self.rows - end + below.len();
        // Words at the end of a short table are not a footer.
        if count == 0 || count > FOOTER_LINES || end < 2 * count || below.iter().any(|odd| odd.is_row) {
            return;
        }
        self.keep((0..end).collect());
        self.odd.retain(|odd| odd.line <= last);
        let lines = plural(count, "line");
        self.notes.push(Note::new(format!("{lines} below the last row skipped, from line {}", last + 1)));
    }

    pub fn leave(&mut self, options: &ReadOptions) -> Result<(), FileFault> {
        for wanted in &options.leave {
            let fault = || FileFault::NotLeft { wanted: wanted.clone(), there: self.names() };
            let place = self.place(wanted).ok_or_else(fault)?;
            self.columns.remove(place);
        }
        Ok(())
    }

    pub fn rename(&mut self, options: &ReadOptions) -> Result<(), FileFault> {
        // All sources are looked up before any name changes, so that two columns can swap their names.
        let places = options.map.iter().map(|(_, wanted)| {
            self.place(wanted).ok_or_else(|| FileFault::Unmapped { wanted: wanted.clone(), there: self.names() })
        });
        let places: Vec<usize> = places.collect::<Result<_, _>>()?;
        for (place, (name, _)) in places.into_iter().zip(&options.map) {
            let column = &mut self.columns[place];
            // Renaming defines the quantity of a column; the file still states its unit.
            column.unit = Named::of(column).unit.or_else(|| unit_of(column, name));
            column.is_unit_open = name == "time_s" && column.name != *name && column.unit.is_none();
            column.name.clone_from(name);
        }
        Ok(())
    }

    /// `; empty cells: temperature_c 8,955; 45 of 9,000 rows have none`
    fn gaps(&self, is_needed: impl Fn(&str) -> bool) -> String {
        let with_gaps: Vec<&Column> =
            self.columns.iter().filter(|column| is_needed(&column.name) && column.found.missing > 0).collect();
        if with_gaps.is_empty() {
            return String::new();
        }
        let named = with_gaps.iter().map(|column| format!("{} {}", column.source, counted(column.found.missing)));
        let whole = |row: &usize| with_gaps.iter().all(|column| !column.values[*row].is_nan());
        let left = (0..self.rows).filter(whole).count();
        format!(
            "; empty cells: {}; {} of {} have none",
            named.collect::<Vec<_>>().join(", "),
            counted(left),
            plural(self.rows, "row")
        )
    }

    /// A row with words in several numeric columns: names or units of another table.
    fn words_between(&self, is_needed: impl Fn(&str) -> bool) -> Option<usize> {
        let wrong: Vec<&[usize]> = self
            .columns
            .iter()
            .filter(|column| is_needed(&column.name) && !column.is_words())
            .map(|column| column.found.wrong_rows.as_slice())
            .collect();
        let is_in = |row: &usize| wrong.iter().filter(|rows| rows.binary_search(row).is_ok()).count() >= SECOND_HEADER;
        wrong.iter().flat_map(|rows| rows.iter()).copied().filter(is_in).min()
    }

    /// Refuses rows with a different number of cells and cells that should be numbers, all in one message.
    pub fn refuse_wrong(
        &self,
        file: &str,
        is_needed: impl Fn(&str) -> bool,
        leave_empty: bool,
    ) -> Result<(), FileError> {
        let other = |column: &&Column| column.other_type.is_some() && is_needed(&column.name);
        if let Some(column) = self.columns.iter().find(other) {
            let found = column.other_type.clone().unwrap_or_default();
            return Err(FileFault::NotNumeric { found }.in_file(file).in_column(&column.name));
        }
        if let Some(row) = self.words_between(&is_needed) {
            return Err(FileError { place: Box::new(self.located(file, row)), fault: FileFault::SecondTable });
        }
        let mut rows: Vec<u64> = self.odd.iter().map(|odd| odd.line).collect();
        let names = self.columns.len();
        let width = |odd: &Odd| Wrong {
            line: odd.line,
            column: None,
            fault: FileFault::Width { expected: names, found: odd.cells },
        };
        let mut shown: Vec<Wrong> = self.odd.iter().take(crate::error::SHOWN_ROWS).map(width).collect();
        let line = |row: usize| self.number_of(row);
        for column in self.columns.iter().filter(|column| is_needed(&column.name)) {
            let missing = column.found.first_missing.iter().filter(|_| !leave_empty);
            shown.extend(column.found.wrong.iter().chain(missing).map(|cell| Wrong {
                line: line(cell.row),
                column: Some(column.name.clone()),
                fault: FileFault::NotNumber { found: cell.text.clone() },
            }));
            rows.extend(column.found.wrong_rows.iter().map(|row| line(*row)));
            if column.found.missing > 0 && !leave_empty {
                let empty = column.values.iter().enumerate().filter(|(_, value)| value.is_nan());
                rows.extend(empty.map(|(row, _)| line(row)));
            }
        }
        rows.sort_unstable();
        rows.dedup();
        // Only the first fault of each row is reported.
        shown.sort_by_key(|wrong| wrong.line);
        shown.dedup_by_key(|wrong| wrong.line);
        shown.truncate(crate::error::SHOWN_ROWS);
        match rows.len() {
            0 => Ok(()),
            _ => Err(FileError::of_rows(file, shown, &rows, self.gaps(is_needed), self)),
        }
    }
}
