//! Why and where a file is refused.

use crate::ProposedOption;
use crate::note::plural;
use crate::omitted_rows::rows_text;
use crate::raw::RawTable;
use crate::text::Decimal;
use jointbench_instrument::{Kind, TableFault};
use std::{fmt, io};

/// Number of wrong rows in a message, in addition to their total number.
pub(crate) const SHOWN_ROWS: usize = 5;

/// Largest number of letters of a word for an empty cell.
const CODE: usize = 12;

/// A refused file: the position of the fault, and the expected content.
#[derive(Debug, thiserror::Error)]
#[error("{}{}", self.cause(), self.remedy())]
pub struct FileError {
    pub place: Box<Place>,
    #[source]
    pub fault: FileFault,
}

/// A position in a file. Lines count from 1 as in an editor; columnar files have rows, counted from 1, instead.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Place {
    pub file: String,
    pub line: Option<u64>,
    pub row: Option<u64>,
    pub column: Option<String>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        if let Some(row) = self.row {
            write!(f, ", row {row}")?;
        }
        match &self.column {
            Some(column) => write!(f, ", column {column}"),
            None => Ok(()),
        }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum FileFault {
    #[error("{}", io_words(.0))]
    Io(io::Error),
    #[error(
        "expected a table that ends in .csv, .tsv, .txt, .dat, .asc, .log or .lvm (also with .gz behind it), .parquet or .arrow; \
         save a workbook (.xlsx, .ods) as CSV"
    )]
    UnknownForm,
    #[error("the file is empty: expected a line of column names, then one line for each sample")]
    Empty,
    #[error("not a whole gzip file ({0}): copy or pack it again")]
    Gzip(String),
    #[error("this file is binary (byte 0x{0:02x}), and a table is expected: save the table as CSV or Parquet")]
    NotText(u8),
    #[error("there are column names and no sample below them: was the table cut off, or is it still being written?")]
    NoRows,
    #[error("{first}{}", rows_after_first(.more, .rows - 1, .gaps))]
    Rows {
        first: Box<FileFault>,
        more: Vec<Wrong>,
        rows: usize,
        /// Columns with empty cells, and the number of rows without empty cells; empty if there are no empty cells.
        gaps: String,
        /// The rows as an option names them, if they are few.
        omitted: Option<String>,
    },
    #[error("numbers stand where the line of column names is expected; a {kind} run needs {}", kind.required_columns().join(", "))]
    NoNames { kind: Kind, options: Vec<ProposedOption> },
    /// A question that the file does not answer, and the options that answer it.
    #[error("{message}")]
    Choice { message: String, options: Vec<ProposedOption> },
    /// A time that does not rise, the probable cause, and the options that correct it.
    #[error("{fault}; {message}")]
    Time { fault: TableFault, message: String, options: Vec<ProposedOption> },
    /// Columns that the file seems to contain under other names.
    #[error("{fault}; {message}")]
    Proposed { fault: TableFault, message: &'static str, options: Vec<ProposedOption> },
    #[error(
        "expected {expected} values as in the line of column names, found {found}{}",
        if found > expected { ": where numbers have commas, semicolons or tabs stand between the columns" } else { "" }
    )]
    Width { expected: usize, found: usize },
    #[error(
        "expected a number, found {}{}",
        shown(.found),
        other_sign(.found).map_or_else(String::new, |decimal| format!(": it is one with --decimal NAME={}", decimal.word()))
    )]
    NotNumber { found: String },
    #[error("expected numbers, found {found}")]
    NotNumeric { found: String },
    #[error("expected a whole number that fits in 53 bits, found {found}")]
    TooLong { found: String },
    #[error("not readable: {0}")]
    Columnar(String),
    #[error(
        "a row of words stands between the rows, as the names or units of another table: save each table as a file of its own"
    )]
    SecondTable,
    #[error("no column holds numbers: name the columns with --names, or remove the lines above them")]
    NoColumns,
    #[error("two columns of time differ by up to {apart}: resample the channels to one clock")]
    TwoClocks { apart: String, options: Vec<ProposedOption> },
    #[error("{0}")]
    Bound(String),
    #[error("{what}: expected one object of facts, such as {{\"kind\": \"friction\", \"gear_ratio\": 50}}")]
    Meta { what: String },
    #[error("{fact} is {found}: expected {expected}")]
    Fact { fact: String, found: String, expected: &'static str },
    #[error("{found} is not known: did you mean {meant}? A fact of your own needs a name that is less like it")]
    Misspelt { found: String, meant: &'static str },
    #[error("the mapping names column {wanted}, which is not in the file: it has {}", .there.join(", "))]
    Unmapped { wanted: String, there: Vec<String> },
    #[error("column {wanted} cannot be omitted, as it is not in the file: it has {}", .there.join(", "))]
    NotLeft { wanted: String, there: Vec<String> },
    #[error("row {wanted} cannot be omitted: the rows of the file are {first} to {last}")]
    NotOmitted { wanted: u64, first: u64, last: u64 },
    #[error("all rows are omitted: keep some of them")]
    AllOmitted,
    #[error("the scale names column {wanted}, which is not in the table: it has {}", .there.join(", "))]
    Unscaled { wanted: String, there: Vec<String> },
    #[error("{0}")]
    Table(TableFault),
}

/// One wrong row.
#[derive(Debug)]
pub struct Wrong {
    pub line: u64,
    pub column: Option<String>,
    pub fault: FileFault,
}

fn rows_after_first(more: &[Wrong], count: usize, gaps: &str) -> String {
    let verb = match count {
        0 => return String::new(),
        1 => "is",
        _ => "are",
    };
    format!("; and {} {verb} wrong: {}{gaps}", plural(count, "more row"), shown_rows(more, count))
}

fn shown_rows(more: &[Wrong], count: usize) -> String {
    if more.is_empty() {
        return "…".to_owned();
    }
    let row = |Wrong { line, column, fault }: &Wrong| match column {
        Some(column) => format!("line {line}, column {column}: {fault}"),
        None => format!("line {line}: {fault}"),
    };
    let rows: Vec<String> = more.iter().map(row).collect();
    rows.join("; ") + if more.len() < count { "; …" } else { "" }
}

fn io_words(fault: &io::Error) -> String {
    match fault.kind() {
        io::ErrorKind::NotFound => "there is no such file: check the name and the folder".to_owned(),
        io::ErrorKind::IsADirectory => "this is a folder: name a file in it".to_owned(),
        io::ErrorKind::PermissionDenied => "it may not be opened: check its permissions".to_owned(),
        _ => fault.to_string(),
    }
}

/// The decimal sign that makes the cell a number.
fn other_sign(found: &str) -> Option<Decimal> {
    let is_one = |decimal: &Decimal| crate::text::number(found.as_bytes(), *decimal).is_some();
    [Decimal::Point, Decimal::Comma].into_iter().find(is_one)
}

fn shown(found: &str) -> String {
    match found {
        "" => "nothing".to_owned(),
        text if text.chars().count() > 40 => format!("“{}…”", text.chars().take(40).collect::<String>()),
        text => format!("“{text}”"),
    }
}

impl FileFault {
    /// Options that accept cells without a number, else the option that omits the wrong rows.
    fn options_of_cells(&self) -> Vec<ProposedOption> {
        let cell = |fault: &Self| if let Self::NotNumber { found } = fault { Some(found.clone()) } else { None };
        let cells: Option<Vec<String>> = match self {
            Self::Rows { first, more, .. } => {
                std::iter::once(first.as_ref()).chain(more.iter().map(|wrong| &wrong.fault)).map(cell).collect()
            }
            fault => cell(fault).map(|cell| vec![cell]),
        };
        let omitted = match self {
            Self::Rows { omitted, .. } => omitted.iter().map(|rows| ProposedOption::new("omit_rows", rows)).collect(),
            _ => Vec::new(),
        };
        let Some(cells) = cells else { return omitted };
        // A cell with a digit is a number in another notation.
        let is_short = |cell: &str| cell.chars().count() <= CODE && !cell.contains(|c: char| c.is_ascii_digit());
        let mut codes: Vec<&str> = cells.iter().map(|cell| cell.trim()).collect();
        codes.retain(|cell| !crate::text::is_missing(cell.as_bytes()));
        codes.sort_unstable();
        codes.dedup();
        if !codes.iter().all(|cell| is_short(cell)) {
            return omitted;
        }
        let (Some(first), more) = (codes.first(), codes.iter().skip(1)) else {
            return vec![ProposedOption::flag("leave_empty_rows")];
        };
        let missing = more.fold(ProposedOption::new("missing", *first), |all, code| all.and("missing", *code));
        vec![missing.and_flag("leave_empty_rows")]
    }

    pub(crate) fn in_file(self, file: &str) -> FileError {
        FileError { place: Box::new(Place { file: file.to_owned(), ..Place::default() }), fault: self }
    }

    pub(crate) fn at_line(self, file: &str, line: u64) -> FileError {
        let place = Place { file: file.to_owned(), line: Some(line), ..Place::default() };
        FileError { place: Box::new(place), fault: self }
    }
}

impl FileError {
    pub(crate) fn in_column(mut self, column: &str) -> Self {
        self.place.column = Some(column.to_owned());
        self
    }

    /// `wrong`: the first of the wrong rows, at least one; `rows`: the numbers of all. The error has the position of the first one.
    pub(crate) fn of_rows(file: &str, mut wrong: Vec<Wrong>, rows: &[u64], gaps: String, table: &RawTable) -> Self {
        let Wrong { line, column, fault } = wrong.remove(0);
        // Where most rows are wrong, the file is read in a wrong way.
        let are_few = 2 * rows.len() < table.rows + table.odd.len();
        let (first, omitted) = (Box::new(fault), rows_text(rows).filter(|_| are_few));
        let fault = FileFault::Rows { first, more: wrong, rows: rows.len(), gaps, omitted };
        let place = Place { file: file.to_owned(), column, ..Place::default() };
        let place = match table.is_text {
            true => Place { line: Some(line), ..place },
            false => Place { row: Some(line), ..place },
        };
        Self { place: Box::new(place), fault }
    }

    /// The column at fault, if the fault is in one column.
    pub fn column(&self) -> Option<&str> {
        match &self.fault {
            FileFault::Table(fault) | FileFault::Time { fault, .. } | FileFault::Proposed { fault, .. } => {
                fault.column()
            }
            _ => self.place.column.as_deref(),
        }
    }

    /// Position of the fault and expected content, without the proposed options.
    pub fn cause(&self) -> String {
        format!("{}: {}", self.place, self.fault)
    }

    /// Proposed options.
    pub fn options(&self) -> Vec<ProposedOption> {
        match &self.fault {
            FileFault::Choice { options, .. }
            | FileFault::NoNames { options, .. }
            | FileFault::TwoClocks { options, .. }
            | FileFault::Time { options, .. }
            | FileFault::Proposed { options, .. } => options.clone(),
            fault => fault.options_of_cells(),
        }
    }

    /// The options as text after the cause.
    fn remedy(&self) -> String {
        let options: Vec<String> = self.options().into_iter().map(|option| option.text).collect();
        match (&self.fault, options) {
            (_, options) if options.is_empty() => String::new(),
            (FileFault::Proposed { .. }, options) => format!(": {}", options.join(" ")),
            (FileFault::Rows { gaps, rows: 2.., .. }, options) if !gaps.is_empty() => {
                format!(". Use {}, or --leave NAME to omit a column", options.join(" or "))
            }
            (_, options) => format!(". Use {}", options.join(" or ")),
        }
    }

    /// A fault of the computer (disk, permission), not of the table.
    pub fn is_io(&self) -> bool {
        matches!(&self.fault, FileFault::Io(fault) if fault.kind() != io::ErrorKind::NotFound)
    }
}
