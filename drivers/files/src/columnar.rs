//! Parquet and Arrow in: columns of any number type, without gaps.

use crate::ReadOptions;
use crate::error::{FileError, FileFault};
use crate::facts::{self, EMBEDDED};
use crate::raw::RawTable;
use crate::{arrow_check, parquet_check};
use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrowPrimitiveType, RecordBatch};
use arrow_ipc::reader::FileReader;
use arrow_schema::{ArrowError, DataType, Schema};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::errors::ParquetError;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Rows decoded at a time.
const BATCH_ROWS: usize = 1 << 16;
/// Whole numbers up to here are exact as doubles.
const LARGEST_EXACT: u64 = 1 << f64::MANTISSA_DIGITS;

pub(crate) fn read_parquet(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<RawTable, FileError> {
    guarded(name, || {
        let fault = |fault: ParquetError| FileFault::Columnar(fault.to_string()).in_file(name);
        let file = bytes::Bytes::copy_from_slice(bytes);
        let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(fault)?;
        parquet_check::check(builder.metadata(), bytes.len() as u64, &options.bounds).map_err(|f| f.in_file(name))?;
        let schema = builder.schema().clone();
        let wanted = wanted(name, &schema, options)?;
        let rows = builder.metadata().file_metadata().num_rows().max(0) as usize;
        options.bounds.check_rows(rows, wanted.len()).map_err(|f| f.in_file(name))?;
        let mask = ProjectionMask::roots(builder.parquet_schema(), wanted.iter().copied());
        let reader = builder.with_projection(mask).with_batch_size(BATCH_ROWS).build().map_err(fault)?;
        collect(name, &schema, &wanted, options, reader)
    })
}

pub(crate) fn read_arrow(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<RawTable, FileError> {
    guarded(name, || {
        arrow_check::check(bytes, &options.bounds).map_err(|fault| fault.in_file(name))?;
        let fault = |fault: ArrowError| FileFault::Columnar(fault.to_string()).in_file(name);
        let whole = FileReader::try_new(Cursor::new(bytes), None).map_err(fault)?;
        let schema = whole.schema();
        let wanted = wanted(name, &schema, options)?;
        let reader = FileReader::try_new(Cursor::new(bytes), Some(wanted.clone())).map_err(fault)?;
        collect(name, &schema, &wanted, options, reader)
    })
}

/// The decoders end some broken files by a panic. What such a file needs is the same refusal.
fn guarded(name: &str, read: impl FnOnce() -> Result<RawTable, FileError>) -> Result<RawTable, FileError> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| {
        let what = "its parts contradict each other: write it again".to_owned();
        Err(FileFault::Columnar(what).in_file(name))
    })
}

/// The columns that are read, by their places: all but those to leave. One that holds no numbers is refused before any of it
/// is decoded.
fn wanted(name: &str, schema: &Schema, options: &ReadOptions) -> Result<Vec<usize>, FileError> {
    let names: Vec<String> = schema.fields().iter().map(|field| field.name().clone()).collect();
    options.bounds.check_columns(&names).map_err(|fault| fault.in_file(name))?;
    let fields = schema.fields().iter().enumerate().filter(|(_, field)| !options.leave.contains(field.name()));
    fields
        .map(|(place, field)| match is_numeric(field.data_type()) {
            true => Ok(place),
            false => {
                let found = field.data_type().to_string();
                Err(FileFault::NotNumeric { found }.in_file(name).in_column(field.name()))
            }
        })
        .collect()
}

fn is_numeric(of: &DataType) -> bool {
    use DataType as D;
    of.is_integer() || matches!(of, D::Float64 | D::Float32 | D::Boolean)
}

fn collect(
    name: &str,
    schema: &Schema,
    wanted: &[usize],
    options: &ReadOptions,
    batches: impl Iterator<Item = Result<RecordBatch, ArrowError>>,
) -> Result<RawTable, FileError> {
    let embedded = schema.metadata().get(EMBEDDED);
    let meta =
        embedded.map(|json| facts::parse_meta(&format!("{name}, embedded meta"), json.as_bytes())).transpose()?;
    let names: Vec<String> = schema.fields().iter().map(|field| field.name().clone()).collect();
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    let mut rows = 0;
    for batch in batches {
        let batch = batch.map_err(|fault| FileFault::Columnar(fault.to_string()).in_file(name))?;
        rows += batch.num_rows();
        options.bounds.check_rows(rows, wanted.len()).map_err(|fault| fault.in_file(name))?;
        for (array, place) in batch.columns().iter().zip(wanted) {
            let column = &mut columns[*place];
            let first = column.len();
            append(array.as_ref(), column, options.leave_empty_rows).map_err(|(row, fault)| {
                let mut error = fault.in_file(name).in_column(&names[*place]);
                error.place.row = row.map(|row| (first + row) as u64 + 1);
                error
            })?;
        }
    }
    Ok(RawTable { names, columns, meta })
}

/// A fault, and the row in the batch where one row is at fault.
type At<T> = Result<T, (Option<usize>, FileFault)>;

fn append(array: &dyn Array, column: &mut Vec<f64>, leave_empty: bool) -> At<()> {
    let empty: Vec<usize> = match array.null_count() {
        0 => Vec::new(),
        _ => (0..array.len()).filter(|row| array.is_null(*row)).collect(),
    };
    if let Some(row) = empty.first().filter(|_| !leave_empty) {
        return Err((Some(*row), FileFault::NotNumber { found: String::new() }));
    }
    let first = column.len();
    match array.data_type() {
        DataType::Float64 => column.extend_from_slice(array.as_primitive::<Float64Type>().values()),
        DataType::Float32 => widen::<Float32Type>(array, column),
        DataType::Int8 => widen::<Int8Type>(array, column),
        DataType::Int16 => widen::<Int16Type>(array, column),
        DataType::Int32 => widen::<Int32Type>(array, column),
        DataType::UInt8 => widen::<UInt8Type>(array, column),
        DataType::UInt16 => widen::<UInt16Type>(array, column),
        DataType::UInt32 => widen::<UInt32Type>(array, column),
        DataType::Int64 => {
            let values = array.as_primitive::<Int64Type>().values();
            exact(values.iter().map(|v| (v.unsigned_abs(), *v as f64)), column)?;
        }
        DataType::UInt64 => {
            let values = array.as_primitive::<UInt64Type>().values();
            exact(values.iter().map(|v| (*v, *v as f64)), column)?;
        }
        DataType::Boolean => column.extend(array.as_boolean().values().iter().map(|on| f64::from(u8::from(on)))),
        other => return Err((None, FileFault::NotNumeric { found: other.to_string() })),
    }
    empty.iter().for_each(|row| column[first + row] = f64::NAN);
    Ok(())
}

fn widen<T: ArrowPrimitiveType>(array: &dyn Array, column: &mut Vec<f64>)
where
    T::Native: Into<f64>,
{
    column.extend(array.as_primitive::<T>().values().iter().map(|value| (*value).into()));
}

fn exact(values: impl Iterator<Item = (u64, f64)>, column: &mut Vec<f64>) -> At<()> {
    for (row, (magnitude, value)) in values.enumerate() {
        if magnitude > LARGEST_EXACT {
            return Err((Some(row), FileFault::TooLong { found: value.to_string() }));
        }
        column.push(value);
    }
    Ok(())
}
