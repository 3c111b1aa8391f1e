//! The preview of a file before its import: its columns, their interpretation, and proposals.

use crate::column::Column;
use crate::error::{FileError, FileFault};
use crate::guess::{Proposal, guess, guess_kind};
use crate::naming::{Named, matches};
use crate::note::Note;
use crate::options::ReadOptions;
use crate::raw::RawTable;
use crate::{ProposedOption, Unit, facts, form};
use jointbench_instrument::{Kind, Meta};
use serde::{Deserialize, Serialize};
use std::path::Path;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Preview {
    /// The kind from the facts, or a guess from the columns.
    pub kind: Kind,
    pub rows: usize,
    pub columns: Vec<PreviewColumn>,
    /// Columns with known names, and probable sources of the other columns.
    pub proposals: Vec<Proposal>,
    pub notes: Vec<Note>,
    /// Columns that are omitted, because no model can use them.
    pub left: Vec<String>,
    /// Why the file cannot be imported as it is.
    pub refused: Option<PreviewFault>,
}

/// One column of the file, unchanged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PreviewColumn {
    pub name: String,
    /// The unit from its name or from a line of units.
    pub unit: Option<String>,
    /// Its first cells.
    pub first: Vec<String>,
    pub is_words: bool,
    /// Cells without a value.
    pub missing: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PreviewFault {
    #[serde(rename = "said")]
    pub message: String,
    /// Line of a text, row of a columnar file.
    pub line: Option<u64>,
    pub column: Option<String>,
    /// The first of the wrong rows.
    pub rows: Vec<WrongRow>,
    /// Number of all wrong rows.
    pub row_count: usize,
    pub options: Vec<ProposedOption>,
}

/// A row that is no sample, and its first fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WrongRow {
    /// Line of a text, row of a columnar file.
    pub line: u64,
    pub column: Option<String>,
    pub message: String,
}

impl From<&FileError> for PreviewFault {
    fn from(error: &FileError) -> Self {
        let (line, column) = (error.place.line.or(error.place.row), error.column().map(str::to_owned));
        let rows = match (&error.fault, line) {
            (FileFault::Rows { first, more, .. }, Some(line)) => {
                let row = |line: u64, column: &Option<String>, fault: &FileFault| WrongRow {
                    line,
                    column: column.clone(),
                    message: fault.to_string(),
                };
                let more = more.iter().map(|wrong| row(wrong.line, &wrong.column, &wrong.fault));
                std::iter::once(row(line, &column, first)).chain(more).collect()
            }
            _ => Vec::new(),
        };
        let row_count = if let FileFault::Rows { rows, .. } = error.fault { rows } else { 0 };
        PreviewFault { message: error.cause(), line, column, rows, row_count, options: error.options() }
    }
}

/// Reads a file like [`crate::understand_upload`] and reports the result. `Err`: nothing can be shown.
pub fn preview(name: &str, path: &Path, options: &ReadOptions) -> Result<Preview, FileError> {
    let mut raw = form::open(name, path, options)?;
    raw.name_all();
    let meta = options.meta_path.as_deref().map(facts::read_meta).transpose()?;
    let meta = meta.or_else(|| options.meta.clone()).or(raw.meta.clone()).unwrap_or_default();
    let kind = meta.kind.unwrap_or_else(|| guess_kind(&raw.columns));
    let mut seen = Preview {
        kind,
        rows: raw.rows,
        columns: raw.columns.iter().map(shown).collect(),
        proposals: proposals(&raw, kind, &meta),
        notes: raw.notes.clone(),
        left: Vec::new(),
        refused: None,
    };
    let meta = Meta { kind: Some(kind), ..meta };
    let understood = raw.understand(name, Some(meta), options).and_then(|understood| {
        seen.left.clone_from(&understood.left);
        seen.notes.clone_from(&understood.notes);
        understood.into_run()
    });
    match understood {
        Ok((_, notes)) => seen.notes = notes,
        Err(error) => seen.refused = Some(PreviewFault::from(&error)),
    }
    Ok(seen)
}

fn shown(column: &Column) -> PreviewColumn {
    const CELLS: usize = 6;
    let first = match column.first.is_empty() {
        true => column.values.iter().take(CELLS).map(f64::to_string).collect(),
        false => column.first.clone(),
    };
    PreviewColumn {
        name: column.name.clone(),
        unit: Named::of(column).unit.filter(|text| Unit::parse(text).is_some()),
        first,
        is_words: column.is_words() || column.other_type.is_some(),
        missing: column.found.missing,
    }
}

fn proposals(raw: &RawTable, kind: Kind, meta: &Meta) -> Vec<Proposal> {
    let sure = matches(&raw.columns, Some(kind), meta.motion).into_iter().map(|one| Proposal {
        column: one.column.to_owned(),
        from: raw.columns[one.place].name.clone(),
        unit: one.unit.map(|(text, _)| text),
    });
    let sure: Vec<Proposal> = sure.collect();
    let is_new = |one: &Proposal| !sure.iter().any(|other| other.column == one.column || other.from == one.from);
    let guessed: Vec<Proposal> = guess(&raw.columns, kind).into_iter().filter(is_new).collect();
    sure.into_iter().chain(guessed).collect()
}
