//! CSV in: one line of names; with or without a byte order mark, LF or CRLF.
//!
//! Between the columns stands what is most frequent in the line of names: a comma, a semicolon or a tab. Where it is no
//! comma, a number may have a comma for its point.

use crate::error::{FileError, FileFault, Wrong};
use crate::raw::RawTable;
use crate::{Bounds, ReadOptions};
use csv::ByteRecord;
use std::io::Read;

/// So many wrong rows are told of, beside how many there are.
const TOLD_ROWS: usize = 5;

/// Bytes that are unpacked between two looks at the bounds.
const UNPACKED_AT_ONCE: u64 = 1 << 24;

pub(crate) fn gunzip(name: &str, bytes: &[u8], bounds: &Bounds) -> Result<Vec<u8>, FileError> {
    let mut text = Vec::new();
    let mut packed = flate2::read::MultiGzDecoder::new(bytes);
    loop {
        let read = (&mut packed).take(UNPACKED_AT_ONCE).read_to_end(&mut text);
        let read = read.map_err(|fault| FileFault::Gzip(fault.to_string()).in_file(name))?;
        bounds.check_expanded(text.len() as u64, Some(bytes.len() as u64)).map_err(|fault| fault.in_file(name))?;
        if read == 0 {
            return Ok(text);
        }
    }
}

/// The columns to leave stay empty, and an empty cell of a row to leave is no number.
pub(crate) fn read(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<RawTable, FileError> {
    if let Err(fault) = std::str::from_utf8(bytes) {
        let at = fault.valid_up_to();
        return Err(FileFault::NotText(bytes[at]).at_line(name, line_at(bytes, at)));
    }
    let text = without_mark(bytes);
    let separator = separator(text);
    let mut reader = reader(text, separator);
    let mut record = ByteRecord::new();
    let mut next = |record: &mut ByteRecord| {
        reader.read_byte_record(record).map_err(|fault| FileFault::Columnar(fault.to_string()).in_file(name))
    };

    if !next(&mut record)? {
        return Err(FileFault::Empty.in_file(name));
    }
    let names = column_names(&record).and_then(|names| options.bounds.check_columns(&names).map(|()| names));
    let names = names.map_err(|fault| fault.at_line(name, line_of_record(text, &record)))?;
    let rows = (text.len() / (names.len() * 8)).min(options.bounds.rows);
    let mut columns: Vec<Vec<f64>> = names.iter().map(|_| Vec::with_capacity(rows)).collect();
    let left: Vec<bool> = names.iter().map(|name| options.leave.contains(name)).collect();
    let (mut wrong, mut wrong_rows) = (Vec::new(), 0);
    let mut rows = 0;
    while next(&mut record)? {
        rows += 1;
        options
            .bounds
            .check_rows(rows, names.len())
            .map_err(|fault| fault.at_line(name, line_of_record(text, &record)))?;
        let Err((column, fault)) = take(&record, &names, &left, options, separator, &mut columns) else { continue };
        wrong_rows += 1;
        if wrong.len() < TOLD_ROWS {
            wrong.push(Wrong { line: line_of_record(text, &record), column, fault });
        }
    }
    if wrong_rows > 0 {
        return Err(FileError::of_rows(name, wrong, wrong_rows));
    }
    match columns.iter().all(Vec::is_empty) {
        true => Err(FileFault::NoRows.at_line(name, 1)),
        false => Ok(RawTable { names, columns, meta: None }),
    }
}

/// Adds a row to the columns. `Err`: the column that is wrong, where it is one, and what is.
fn take(
    record: &ByteRecord,
    names: &[String],
    left: &[bool],
    options: &ReadOptions,
    separator: u8,
    columns: &mut [Vec<f64>],
) -> Result<(), (Option<String>, FileFault)> {
    if record.len() != names.len() {
        return Err((None, FileFault::Width { expected: names.len(), found: record.len() }));
    }
    let fields = columns.iter_mut().zip(record).zip(names).zip(left).filter(|(_, left)| !**left);
    for (((column, field), name), _) in fields {
        options.bounds.check_cell(field.len()).map_err(|fault| (Some(name.clone()), fault))?;
        let empty = options.leave_empty_rows && field.trim_ascii().is_empty();
        let value = if empty { Some(f64::NAN) } else { number(field, separator) };
        let found = || FileFault::NotNumber { found: String::from_utf8_lossy(field).into_owned() };
        column.push(value.ok_or_else(|| (Some(name.clone()), found()))?);
    }
    Ok(())
}

fn reader(text: &[u8], separator: u8) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new().delimiter(separator).has_headers(false).flexible(true).from_reader(text)
}

/// The most frequent of the separators in the line of names, outside quotation marks.
fn separator(text: &[u8]) -> u8 {
    let line = text.split(|byte| *byte == b'\n').find(|line| !line.trim_ascii().is_empty()).unwrap_or_default();
    let plain: Vec<u8> = line.split(|byte| *byte == b'"').step_by(2).flatten().copied().collect();
    let count = |separator: u8| plain.iter().filter(|byte| **byte == separator).count();
    // The last of several that are as frequent is taken.
    [b'\t', b';', b','].into_iter().max_by_key(|separator| count(*separator)).unwrap_or(b',')
}

fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

fn column_names(record: &ByteRecord) -> Result<Vec<String>, FileFault> {
    let names: Vec<String> = record.iter().map(|field| String::from_utf8_lossy(field).trim().to_owned()).collect();
    if names.iter().all(|name| name.parse::<f64>().is_ok()) {
        return Err(FileFault::NoNames);
    }
    match names.iter().position(String::is_empty) {
        Some(place) => Err(FileFault::NoName { number: place + 1 }),
        None => Ok(names),
    }
}

/// The nearest double to a decimal number; blanks around it are let pass.
fn number(field: &[u8], separator: u8) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?;
    let plain = text.parse().or_else(|_| text.trim().parse()).ok();
    match text.split_once(',').filter(|_| separator != b',') {
        Some((whole, part)) if !whole.contains('.') => {
            format!("{}.{}", whole.trim_start(), part.trim_end()).parse().ok()
        }
        _ => plain,
    }
}

/// The line, from 1, on which the data row `row`, from 0, begins.
pub(crate) fn line_of(bytes: &[u8], row: usize) -> Option<u64> {
    let text = without_mark(bytes);
    let mut reader = reader(text, separator(text));
    let mut record = ByteRecord::new();
    for _ in 0..row + 2 {
        reader.read_byte_record(&mut record).ok().filter(|there| *there)?;
    }
    Some(line_of_record(text, &record))
}

fn line_of_record(text: &[u8], record: &ByteRecord) -> u64 {
    let start = record.position().map_or(0, |position| position.byte() as usize);
    // The reader notes where it began to look; empty lines come before the record.
    let blank = text[start..].iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
    line_at(text, start + blank)
}

fn line_at(text: &[u8], at: usize) -> u64 {
    text[..at].iter().filter(|byte| **byte == b'\n').count() as u64 + 1
}
