//! CSV in: comma-separated, one line of names, points in the numbers; with or without a byte order mark, LF or CRLF.

use crate::error::{FileError, FileFault};
use crate::raw::RawTable;
use csv::ByteRecord;
use std::io::Read;

/// A packed file that unpacks to more than this is refused before it fills the memory.
const MOST_UNPACKED_BYTES: u64 = 4 << 30;

pub(crate) fn gunzip(name: &str, bytes: &[u8]) -> Result<Vec<u8>, FileError> {
    let mut text = Vec::with_capacity(bytes.len() * 4);
    let unpacked = flate2::read::MultiGzDecoder::new(bytes).take(MOST_UNPACKED_BYTES + 1).read_to_end(&mut text);
    match unpacked {
        Err(fault) => Err(FileFault::Gzip(fault.to_string()).in_file(name)),
        Ok(size) if size as u64 > MOST_UNPACKED_BYTES => {
            Err(FileFault::Gzip("it unpacks to more than 4 GiB".to_owned()).in_file(name))
        }
        Ok(_) => Ok(text),
    }
}

pub(crate) fn read(name: &str, bytes: &[u8]) -> Result<RawTable, FileError> {
    if let Err(fault) = std::str::from_utf8(bytes) {
        let at = fault.valid_up_to();
        return Err(FileFault::NotText(bytes[at]).at_line(name, line_at(bytes, at)));
    }
    let text = without_mark(bytes);
    let mut reader = reader(text);
    let mut record = ByteRecord::new();
    let mut next = |record: &mut ByteRecord| {
        reader.read_byte_record(record).map_err(|fault| FileFault::Columnar(fault.to_string()).in_file(name))
    };

    if !next(&mut record)? {
        return Err(FileFault::Empty.in_file(name));
    }
    let names = column_names(&record).map_err(|fault| fault.at_line(name, line_of_record(text, &record)))?;
    let rows = text.len() / (names.len() * 8);
    let mut columns: Vec<Vec<f64>> = names.iter().map(|_| Vec::with_capacity(rows)).collect();
    while next(&mut record)? {
        if record.len() != names.len() {
            let fault = FileFault::Width { expected: names.len(), found: record.len() };
            return Err(fault.at_line(name, line_of_record(text, &record)));
        }
        for ((column, field), column_name) in columns.iter_mut().zip(&record).zip(&names) {
            match number(field) {
                Some(value) => column.push(value),
                None => {
                    let found = String::from_utf8_lossy(field).into_owned();
                    let fault = FileFault::NotNumber { found }.at_line(name, line_of_record(text, &record));
                    return Err(fault.in_column(column_name));
                }
            }
        }
    }
    Ok(RawTable { names, columns, meta: None })
}

fn reader(text: &[u8]) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text)
}

fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

fn column_names(record: &ByteRecord) -> Result<Vec<String>, FileFault> {
    let names: Vec<String> = record.iter().map(|field| String::from_utf8_lossy(field).trim().to_owned()).collect();
    if let [only] = names.as_slice() {
        let found = [(';', "semicolons"), ('\t', "tabs")].into_iter().find(|(separator, _)| only.contains(*separator));
        if let Some((_, found)) = found {
            return Err(FileFault::Separator { found });
        }
    }
    match names.iter().position(String::is_empty) {
        Some(place) => Err(FileFault::NoName { number: place + 1 }),
        None => Ok(names),
    }
}

/// The nearest double to a decimal number; blanks around it are let pass.
fn number(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?;
    text.parse().or_else(|_| text.trim().parse()).ok()
}

/// The line, from 1, on which the data row `row`, from 0, begins.
pub(crate) fn line_of(bytes: &[u8], row: usize) -> Option<u64> {
    let text = without_mark(bytes);
    let mut reader = reader(text);
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
