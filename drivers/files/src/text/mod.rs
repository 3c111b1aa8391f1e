//! Imports text: CSV and similar formats. Reads in pieces, so that memory only holds the numbers of a file.
//!
//! The first lines determine how all other lines are read ([`layout`]). The csv crate splits rows and cells. The
//! detection of the layout and the interpretation of cells are implemented here.

mod cell;
mod content;
mod encoding;
mod layout;
mod line;
mod rows;
mod source;
mod stamp;

pub use cell::{Decimal, Shape, is_missing, number};
pub use content::Content;
pub use rows::Lines;
pub use source::{Packed, Plain, Source};
pub use stamp::Stamp;

use crate::column::Column;
use crate::error::{FileError, FileFault};
use crate::note::{Note, plural};
use crate::raw::{Odd, RawTable};
use crate::{ProposedOption, ReadOptions};
use layout::Layout;
use line::Separator;
use rayon::prelude::*;
use rows::{Part, Rows};
use source::Pieces;

/// Bytes at the beginning that determine the layout of the rest.
const HEAD_BYTES: usize = 256 << 10;

/// `bytes`: size of the text, if it is known; used to reserve memory.
pub(crate) fn read(
    name: &str,
    source: &mut dyn Source,
    bytes: Option<u64>,
    options: &ReadOptions,
) -> Result<RawTable, FileError> {
    let mut pieces = Pieces::new(source);
    let in_file = |fault: FileFault| fault.in_file(name);
    let Some((first, is_last)) = pieces.next().map_err(in_file)? else { return Err(FileFault::Empty.in_file(name)) };
    let head = &first[..first.len().min(HEAD_BYTES)];
    let layout = Layout::of(head, is_last && head.len() == first.len(), options.decimal_of_all());
    let names_line = layout.names_line.unwrap_or(1);
    let mut table = table(&layout, options).map_err(|fault| fault.at_line(name, names_line))?;
    table.notes = notes(&layout, &pieces);
    let names: Vec<String> = layout.columns.iter().map(|column| column.name.clone()).collect();
    let rows = Rows {
        separator: layout.separator,
        ways: ways(&layout, &table, options),
        names,
        missing: &options.missing,
        bounds: &options.bounds,
    };
    let guess = bytes.map_or(0, |bytes| guess_rows(&first, bytes)).min(options.bounds.rows);
    for (column, way) in table.columns.iter_mut().zip(&rows.ways) {
        column.values.reserve(if way.is_left { 0 } else { guess });
    }
    let begin = first[layout.start.min(first.len())..].to_vec();
    let mut line = layout.start_line - 1;
    let (mut batch, mut read, mut broken) = (vec![(begin, is_last)], Vec::new(), None);
    // While one batch is parsed, the previous one is appended to the table and the next one is read from disk.
    while !batch.is_empty() {
        let (parts, (joined, next)) = rayon::join(
            || batch.par_iter().map(|(text, is_last)| rows.part(text, *is_last)).collect::<Vec<Part>>(),
            || {
                let joined = read.drain(..).try_for_each(|part| append(&mut table, part, &mut line, name, options));
                (joined, pieces.batch(2 * rayon::current_num_threads()))
            },
        );
        joined?;
        read = parts;
        batch = next.unwrap_or_else(|fault| {
            broken = Some(fault);
            Vec::new()
        });
    }
    // A wrong cell in the bytes that were read is reported before a later disk error.
    read.into_iter().try_for_each(|part| append(&mut table, part, &mut line, name, options))?;
    if let Some(fault) = broken {
        return Err(in_file(fault));
    }
    finish(table, &layout, name)
}

/// The empty table.
fn table(layout: &Layout, options: &ReadOptions) -> Result<RawTable, FileFault> {
    let mut names: Vec<String> = layout.columns.iter().map(|column| column.name.clone()).collect();
    options.bounds.check_columns(&names)?;
    let is_named = layout.names_line.is_some();
    if !options.names.is_empty() {
        let (found, given) = (layout.width(), options.names.len());
        if found != given {
            let message = format!("--names gives {given} names, and the table has {}", plural(found, "column"));
            return Err(FileFault::Choice {
                message,
                options: vec![ProposedOption::open("names", proposed_names(layout))],
            });
        }
        options.names.iter().zip(&mut names).for_each(|(given, name)| name.clone_from(given));
    }
    options.bounds.check_columns(&names)?;
    let columns = layout.columns.iter().zip(names).map(|(column, name)| Column {
        name,
        unit: column.unit.clone(),
        content: column.content,
        first: column.first.clone(),
        ..Column::default()
    });
    Ok(RawTable {
        names_line: layout.names_line.unwrap_or(1),
        decimal: layout.decimal,
        proposed_names: (!is_named && options.names.is_empty()).then(|| proposed_names(layout)),
        ..RawTable::of_text(columns.collect())
    })
}

/// `time,column_2,…`: the first column is named time if it rises. Its unit is unknown.
fn proposed_names(layout: &Layout) -> String {
    let rises = layout.columns.first().is_some_and(|column| {
        let values: Vec<f64> = column
            .first
            .iter()
            .filter_map(|cell| cell::number(cell.as_bytes(), layout.decimal))
            .map(|(value, _)| value)
            .collect();
        values.len() > 1 && values.windows(2).all(|pair| pair[0] < pair[1])
    });
    let name = |place: usize| if place == 0 && rises { "time".to_owned() } else { format!("column_{}", place + 1) };
    (0..layout.width()).map(name).collect::<Vec<String>>().join(",")
}

fn ways(layout: &Layout, table: &RawTable, options: &ReadOptions) -> Vec<rows::Way> {
    let mut ways = layout.ways();
    for (way, column) in ways.iter_mut().zip(&table.columns) {
        way.is_left |= options.leave.contains(&column.name);
        way.decimal = options.decimal_of(&column.name).unwrap_or(way.decimal);
    }
    ways
}

/// Estimated number of rows of a text of `bytes`, from its first lines.
fn guess_rows(first: &[u8], bytes: u64) -> usize {
    let lines = first.iter().filter(|byte| **byte == b'\n').count().max(1) as u64;
    (bytes / (first.len() as u64 / lines).max(1)) as usize
}

fn append(
    table: &mut RawTable,
    mut part: Part,
    line: &mut u64,
    name: &str,
    options: &ReadOptions,
) -> Result<(), FileError> {
    if let Some((at, place, fault)) = part.refused {
        let error = fault.at_line(name, *line + at);
        return Err(error.in_column(&table.columns[place].name));
    }
    let rows = table.rows;
    for (column, (values, found)) in table.columns.iter_mut().zip(std::mem::take(&mut part.columns)) {
        column.append(rows, &values, found);
    }
    table.rows += part.rows;
    table.comments += part.comments;
    table.is_cut |= part.is_cut;
    table.named_again.extend(part.named_again.iter().map(|row| row + rows));
    let odd = |(at, cells, is_row): (u64, usize, bool)| Odd { line: *line + at, cells, is_row };
    table.odd.extend(part.odd.iter().copied().map(odd));
    table.lines.append(part.lines, rows, *line);
    *line += part.ends;
    let columns = table.columns.iter().filter(|column| !column.values.is_empty()).count();
    options.bounds.check_rows(table.rows, columns).map_err(|fault| {
        let beyond = table.lines.of(options.bounds.rows.min(table.rows - 1));
        fault.at_line(name, beyond.unwrap_or(*line))
    })
}

fn finish(mut table: RawTable, layout: &Layout, name: &str) -> Result<RawTable, FileError> {
    if table.rows == 0 && table.odd.is_empty() {
        return Err(FileFault::NoRows.at_line(name, table.names_line));
    }
    let is_kept: Vec<bool> = layout.columns.iter().map(|column| column.content != Content::Empty).collect();
    let mut kept = is_kept.iter();
    table.columns.retain(|_| *kept.next().unwrap_or(&true));
    table.leave_footer();
    if table.comments > 0 {
        table.notes.push(Note::new(format!("{} between the rows skipped", plural(table.comments, "comment line"))));
    }
    if table.is_cut {
        table.notes.push(Note::new(
            "the last line is shorter than all others and has no line end: it is truncated and omitted",
        ));
    }
    if !table.named_again.is_empty() {
        let times = plural(table.named_again.len(), "time");
        table.notes.push(Note::new(format!("the line of names is repeated {times} between the rows and was skipped")));
    }
    Ok(table)
}

/// Notes about skipped or assumed parts of the layout.
fn notes(layout: &Layout, pieces: &Pieces<'_>) -> Vec<Note> {
    let mut notes = Vec::new();
    if let Some(coding) = pieces.coding.filter(|coding| coding.encoding != encoding_rs::UTF_8) {
        notes.push(Note::new(format!("the text was read as {}", coding.encoding.name())));
    }
    if layout.above > 0 {
        let message = match layout.comments_above {
            0 => format!("{} above the names skipped", plural(layout.above, "line")),
            count if count == layout.above => format!("{} above the names skipped", plural(count, "comment line")),
            count => format!("{} above the names skipped, {count} of them comments", plural(layout.above, "line")),
        };
        notes.push(Note::new(message));
    }
    if matches!(layout.separator, Separator::Blanks | Separator::Sign(b'|')) {
        notes.push(Note::new(format!("columns are separated by {}", layout.separator.name())));
    }
    if layout.decimal == Decimal::Comma {
        notes.push(Note::with("numbers have a decimal comma", ProposedOption::new("decimal", "point")));
    }
    if let Some(line) = layout.units_line {
        notes.push(Note::new(format!("line {line} was taken as units")));
    }
    if !layout.extra_names.is_empty() {
        let names: Vec<String> = layout.extra_names.iter().map(|name| format!("“{name}”")).collect();
        notes.push(Note::new(format!("no row has a value for {}", names.join(", "))));
    }
    notes
}
