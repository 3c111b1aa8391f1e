//! Run tables as files: CSV (also gzipped), Parquet and Arrow in; CSV, Parquet and MATLAB out.
//!
//! What goes out comes in again bit by bit. What comes in is checked whole before anything is returned, and refused with
//! file, line, column and what was expected.

#![cfg_attr(not(test), warn(clippy::unwrap_used))]

mod arrow_check;
mod bounds;
mod columnar;
mod csv_in;
mod csv_out;
mod error;
mod facts;
mod mat_out;
mod options;
mod parquet_check;
mod parquet_out;
mod raw;
mod table_out;

pub use bounds::Bounds;
pub use csv_out::{CsvWriter, write_csv};
pub use error::{FileError, FileFault, Place, Wrong};
pub use facts::{meta_json, meta_path_of, parse_meta};
pub use mat_out::{MatWriter, write_mat};
pub use options::{OptionFault, ReadOptions, parse_map, parse_scale};
pub use parquet_out::{ParquetWriter, write_parquet};
pub use raw::LEFT_OUT_ROWS;
pub use table_out::{TableColumn, write_table_csv, write_table_parquet};

use jointbench_instrument::{Meta, RunTable, Trace};
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// A file's form, told by the end of its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Csv,
    GzippedCsv,
    Parquet,
    Arrow,
}

impl Form {
    fn of(name: &str) -> Option<Form> {
        let name = name.to_ascii_lowercase();
        [
            (".csv", Form::Csv),
            (".csv.gz", Form::GzippedCsv),
            (".parquet", Form::Parquet),
            (".arrow", Form::Arrow),
            (".feather", Form::Arrow),
        ]
        .into_iter()
        .find_map(|(end, form)| name.ends_with(end).then_some(form))
    }
}

/// Reads a run table with its facts: `options.meta_path`, else what is embedded, else `<name>.meta.json` or `meta.json`
/// beside the file.
pub fn read(path: &Path, options: &ReadOptions) -> Result<RunTable, FileError> {
    let name = path.display().to_string();
    let bytes = fs::read(path).map_err(|fault| FileFault::Io(fault).in_file(&name))?;
    let raw = raw_table(&name, &bytes, options)?;
    let beside = match (&options.meta_path, &options.meta, &raw.meta) {
        (Some(path), _, _) => Some(facts::read_meta(path)?),
        (None, None, None) => facts::beside(path).map(|path| facts::read_meta(&path)).transpose()?,
        _ => None,
    };
    raw.into_table(&name, &bytes, beside, options)
}

/// Reads a run table that came over a wire. `name` tells the form and stands in messages; nothing is looked for beside it.
pub fn read_bytes(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<RunTable, FileError> {
    let meta = options.meta_path.as_deref().map(facts::read_meta).transpose()?;
    raw_table(name, bytes, options)?.into_table(name, bytes, meta, options)
}

fn raw_table(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<raw::RawTable, FileError> {
    match Form::of(name).ok_or_else(|| FileFault::UnknownForm.in_file(name))? {
        Form::Csv => csv_in::read(name, bytes, options),
        Form::GzippedCsv => csv_in::read(name, &csv_in::gunzip(name, bytes, &options.bounds)?, options),
        Form::Parquet => columnar::read_parquet(name, bytes, options),
        Form::Arrow => columnar::read_arrow(name, bytes, options),
    }
}

/// Writes a run to `path` in the form that its name tells: Parquet with embedded facts, or CSV (also `.csv.gz`) with
/// `<name>.meta.json` beside it.
pub fn write(path: &Path, meta: &Meta, trace: &Trace) -> Result<(), FileError> {
    let name = path.display().to_string();
    let io_fault = |fault: io::Error| FileFault::Io(fault).in_file(&name);
    let form = Form::of(&name).filter(|form| *form != Form::Arrow);
    let form = form.ok_or_else(|| FileFault::UnknownForm.in_file(&name))?;
    let mut out = BufWriter::new(fs::File::create(path).map_err(io_fault)?);
    match form {
        Form::Parquet => write_parquet(&mut out, meta, trace).map_err(io_fault)?,
        Form::GzippedCsv => {
            let mut packed = flate2::write::GzEncoder::new(&mut out, flate2::Compression::default());
            write_csv(&mut packed, trace).map_err(io_fault)?;
            packed.finish().map_err(io_fault)?;
        }
        _ => write_csv(&mut out, trace).map_err(io_fault)?,
    }
    out.flush().map_err(io_fault)?;
    if form != Form::Parquet {
        let beside = meta_path_of(path);
        let name = beside.display().to_string();
        fs::write(&beside, meta_json(meta, trace.channels())).map_err(|fault| FileFault::Io(fault).in_file(&name))?;
    }
    Ok(())
}
