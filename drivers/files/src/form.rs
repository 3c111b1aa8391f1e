//! The form of a file, determined by its suffix, and its conversion to a raw table.

use crate::error::{FileError, FileFault};
use crate::raw::RawTable;
use crate::text::{self, Packed, Plain};
use crate::{ReadOptions, columnar};
use std::fs::{self, File};
use std::path::Path;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    Text,
    PackedText,
    Parquet,
    Arrow,
}

/// Suffixes of text files with rows, with any column separator.
const TEXTS: [&str; 7] = [".csv", ".tsv", ".txt", ".dat", ".asc", ".log", ".lvm"];

impl Form {
    pub fn of(name: &str) -> Option<Form> {
        let name = name.to_ascii_lowercase();
        let is_text = |name: &str| TEXTS.iter().any(|end| name.ends_with(end));
        match () {
            () if is_text(&name) => Some(Form::Text),
            () if name.strip_suffix(".gz").is_some_and(is_text) => Some(Form::PackedText),
            () if name.ends_with(".parquet") => Some(Form::Parquet),
            () if name.ends_with(".arrow") || name.ends_with(".feather") => Some(Form::Arrow),
            () => None,
        }
    }

    fn named(name: &str) -> Result<Form, FileError> {
        Form::of(name).ok_or_else(|| FileFault::UnknownForm.in_file(name))
    }
}

/// Reads a file. Text of any length is read in pieces, so that memory use is limited.
pub(crate) fn open(name: &str, path: &Path, options: &ReadOptions) -> Result<RawTable, FileError> {
    let io_fault = |fault| FileFault::Io(fault).in_file(name);
    // A missing file is reported before an unknown suffix.
    let file = File::open(path).map_err(io_fault)?;
    match Form::named(name)? {
        Form::Text => {
            let bytes = file.metadata().map_err(io_fault)?;
            if bytes.is_dir() {
                return Err(io_fault(std::io::ErrorKind::IsADirectory.into()));
            }
            text::read(name, &mut Plain(file), Some(bytes.len()), options)
        }
        Form::PackedText => text::read(name, &mut Packed::new(file, options.bounds), None, options),
        Form::Parquet | Form::Arrow => of_bytes(name, &fs::read(path).map_err(io_fault)?, options),
    }
}

pub(crate) fn of_bytes(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<RawTable, FileError> {
    match Form::named(name)? {
        Form::Text => text::read(name, &mut Plain(bytes), Some(bytes.len() as u64), options),
        Form::PackedText => text::read(name, &mut Packed::new(bytes, options.bounds), None, options),
        Form::Parquet => columnar::read_parquet(name, bytes, options),
        Form::Arrow => columnar::read_arrow(name, bytes, options),
    }
}
