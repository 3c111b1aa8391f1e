//! Run tables as files: imports CSV (also gzipped), Parquet and Arrow; exports CSV, Parquet and MATLAB.
//!
//! An exported table imports again with identical bits. An imported table is checked completely before it is returned.
//! A refusal states file, line, column and expected content.

#![cfg_attr(not(test), warn(clippy::unwrap_used))]

mod arrow_check;
mod arrow_out;
mod bounds;
mod column;
mod columnar;
mod contradiction;
mod csv_out;
mod curve;
mod error;
mod facts;
mod form;
mod guess;
mod mat_out;
mod missing;
mod naming;
mod note;
mod omitted_rows;
mod operating_points;
mod options;
mod order;
mod parquet_check;
mod parquet_columns;
mod parquet_out;
mod preview;
mod proposed_option;
mod raw;
mod table_out;
mod text;
mod time;
mod understand;
mod unit;

pub use arrow_out::ArrowWriter;
pub use bounds::Bounds;
pub use csv_out::{CsvWriter, write_csv};
pub use curve::read_curve;
pub use error::{FileError, FileFault, Place, Wrong};
pub use facts::{meta_json, meta_path_of, parse_meta};
pub use guess::Proposal;
pub use mat_out::{MatWriter, write_mat};
pub use note::{Note, paragraph};
pub use omitted_rows::LEFT_OUT_ROWS;
pub use options::{Choices, OptionFault, ReadOptions, TimeFrom, parse_map, parse_scale};
pub use parquet_columns::parquet_doubles;
pub use parquet_out::{Annotations, ParquetWriter, write_parquet};
pub use preview::{Preview, PreviewColumn, WrongRow, preview};
pub use proposed_option::{OptionPart, ProposedOption};
pub use table_out::{TableColumn, write_table_csv, write_table_parquet};
pub use text::Decimal;
pub use understand::Understood;
pub use unit::{Dimension, Unit, dimension_of};

use form::Form;
use jointbench_instrument::{Meta, RunTable, Trace};
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Reads a run table with its facts. The facts come from `options.meta_path`, else from the file itself, else from
/// `<name>.meta.json` or `meta.json` in the same folder.
pub fn read(path: &Path, options: &ReadOptions) -> Result<RunTable, FileError> {
    Ok(understand(path, options)?.into_run()?.0)
}

/// The content of a file, before it is known whether it is a complete run: see [`Understood::into_run`].
pub fn understand(path: &Path, options: &ReadOptions) -> Result<Understood, FileError> {
    let name = path.display().to_string();
    understand_as(&name, path, facts::beside(path), options)
}

/// The same for an uploaded file. `name` determines its form and appears in messages. No facts are read from the
/// folder.
pub fn understand_upload(name: &str, path: &Path, options: &ReadOptions) -> Result<Understood, FileError> {
    understand_as(name, path, None, options)
}

fn understand_as(
    name: &str,
    path: &Path,
    beside: Option<std::path::PathBuf>,
    options: &ReadOptions,
) -> Result<Understood, FileError> {
    let raw = form::open(name, path, options)?;
    let beside = match (&options.meta_path, &options.meta, &raw.meta) {
        (Some(path), _, _) => Some(facts::read_meta(path)?),
        (None, None, None) => beside.map(|path| facts::read_meta(&path)).transpose()?,
        _ => None,
    };
    raw.understand(name, beside, options)
}

/// Reads a run table from memory. `name` determines its form and appears in messages. No facts are read from a folder.
pub fn read_bytes(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<RunTable, FileError> {
    Ok(understand_bytes(name, bytes, options)?.into_run()?.0)
}

/// The content of a table in memory.
pub fn understand_bytes(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Understood, FileError> {
    let meta = options.meta_path.as_deref().map(facts::read_meta).transpose()?;
    form::of_bytes(name, bytes, options)?.understand(name, meta, options)
}

/// Writes a run to `path` in the form of its suffix: Parquet with embedded facts, or CSV (also `.csv.gz`) with
/// `<name>.meta.json` in the same folder.
pub fn write(path: &Path, meta: &Meta, trace: &Trace) -> Result<(), FileError> {
    let name = path.display().to_string();
    let io_fault = |fault: io::Error| FileFault::Io(fault).in_file(&name);
    let form = Form::of(&name).filter(|form| *form != Form::Arrow);
    let form = form.ok_or_else(|| FileFault::UnknownForm.in_file(&name))?;
    let mut out = BufWriter::new(fs::File::create(path).map_err(io_fault)?);
    match form {
        Form::Parquet => write_parquet(&mut out, meta, trace).map_err(io_fault)?,
        Form::PackedText => {
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
