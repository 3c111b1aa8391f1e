//! Imports Parquet and Arrow: columns of any number type, clocks, and empty cells.

use crate::ReadOptions;
use crate::column::Column;
use crate::error::{FileError, FileFault};
use crate::facts::{self, EMBEDDED};
use crate::raw::RawTable;
use crate::text::{Content, Stamp};
use crate::{arrow_check, parquet_check};
use arrow_array::cast::AsArray;
use arrow_array::types::{
    DurationMicrosecondType, DurationMillisecondType, DurationNanosecondType, DurationSecondType, Float32Type,
    Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, TimestampMicrosecondType, TimestampMillisecondType,
    TimestampNanosecondType, TimestampSecondType, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrowPrimitiveType, RecordBatch};
use arrow_ipc::reader::FileReader;
use arrow_schema::{ArrowError, DataType, Field, Schema, TimeUnit};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::errors::ParquetError;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Rows decoded at a time.
pub(crate) const BATCH_ROWS: usize = 1 << 16;
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

/// The decoders panic on some broken files. Such a file gets the same refusal as other broken files.
fn guarded(name: &str, read: impl FnOnce() -> Result<RawTable, FileError>) -> Result<RawTable, FileError> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| {
        let what = "its parts contradict each other: write it again".to_owned();
        Err(FileFault::Columnar(what).in_file(name))
    })
}

/// Indices of the columns to read: all columns except omitted and non-numeric ones.
fn wanted(name: &str, schema: &Schema, options: &ReadOptions) -> Result<Vec<usize>, FileError> {
    let names: Vec<String> = schema.fields().iter().map(|field| field.name().clone()).collect();
    options.bounds.check_columns(&names).map_err(|fault| fault.in_file(name))?;
    let fields = schema.fields().iter().enumerate();
    let is_read = |field: &Field| !options.leave.contains(field.name()) && is_numeric(field.data_type());
    Ok(fields.filter(|(_, field)| is_read(field)).map(|(place, _)| place).collect())
}

fn is_numeric(of: &DataType) -> bool {
    use DataType as D;
    of.is_integer() || matches!(of, D::Float64 | D::Float32 | D::Boolean | D::Timestamp(_, _) | D::Duration(_))
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
    let mut columns: Vec<Column> = schema.fields().iter().map(|field| empty(field)).collect();
    let mut clocks: Vec<Option<i64>> = vec![None; columns.len()];
    let mut rows = 0;
    for batch in batches {
        let batch = batch.map_err(|fault| FileFault::Columnar(fault.to_string()).in_file(name))?;
        rows += batch.num_rows();
        options.bounds.check_rows(rows, wanted.len()).map_err(|fault| fault.in_file(name))?;
        for (array, place) in batch.columns().iter().zip(wanted) {
            let column = &mut columns[*place];
            let first = column.values.len();
            append(array.as_ref(), column, &mut clocks[*place]).map_err(|(row, fault)| {
                let mut error = fault.in_file(name).in_column(&column.name);
                error.place.row = row.map(|row| (first + row) as u64 + 1);
                error
            })?;
        }
    }
    Ok(RawTable { columns, rows, meta, ..RawTable::default() })
}

fn empty(field: &Field) -> Column {
    let (name, of) = (field.name().clone(), field.data_type());
    let content = match of {
        DataType::Timestamp(_, _) | DataType::Duration(_) => Content::Stamps(Stamp::Date(0)),
        _ => Content::Numbers,
    };
    Column { name, content, other_type: (!is_numeric(of)).then(|| of.to_string()), ..Column::default() }
}

/// A fault, and its row in the batch if the fault is in one row.
type At<T> = Result<T, (Option<usize>, FileFault)>;

fn append(array: &dyn Array, into: &mut Column, clock: &mut Option<i64>) -> At<()> {
    let empty: Vec<usize> = match array.null_count() {
        0 => Vec::new(),
        _ => (0..array.len()).filter(|row| array.is_null(*row)).collect(),
    };
    let first = into.values.len();
    let column = &mut into.values;
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
        DataType::Timestamp(unit, _) | DataType::Duration(unit) => {
            let ticks = ticks(array, *unit);
            let zero = *clock.get_or_insert_with(|| ticks.first().copied().unwrap_or(0));
            column.extend(ticks.iter().map(|tick| tick.wrapping_sub(zero) as f64 * tick_s(*unit)));
        }
        other => return Err((None, FileFault::NotNumeric { found: other.to_string() })),
    }
    into.found.numbers += array.len() - empty.len();
    for row in empty {
        into.values[first + row] = f64::NAN;
        into.found.missing(first + row, b"");
    }
    for row in first..into.values.len() {
        // NaN in a numeric file is a missing value.
        if into.values[row].is_nan() && !array.is_null(row - first) {
            into.found.missing(row, b"NaN");
        }
    }
    Ok(())
}

fn tick_s(unit: TimeUnit) -> f64 {
    match unit {
        TimeUnit::Second => 1.0,
        TimeUnit::Millisecond => 1e-3,
        TimeUnit::Microsecond => 1e-6,
        TimeUnit::Nanosecond => 1e-9,
    }
}

/// The ticks of a clock or of a duration.
fn ticks(array: &dyn Array, unit: TimeUnit) -> Vec<i64> {
    let is_clock = matches!(array.data_type(), DataType::Timestamp(_, _));
    match (unit, is_clock) {
        (TimeUnit::Second, true) => array.as_primitive::<TimestampSecondType>().values().to_vec(),
        (TimeUnit::Millisecond, true) => array.as_primitive::<TimestampMillisecondType>().values().to_vec(),
        (TimeUnit::Microsecond, true) => array.as_primitive::<TimestampMicrosecondType>().values().to_vec(),
        (TimeUnit::Nanosecond, true) => array.as_primitive::<TimestampNanosecondType>().values().to_vec(),
        (TimeUnit::Second, false) => array.as_primitive::<DurationSecondType>().values().to_vec(),
        (TimeUnit::Millisecond, false) => array.as_primitive::<DurationMillisecondType>().values().to_vec(),
        (TimeUnit::Microsecond, false) => array.as_primitive::<DurationMicrosecondType>().values().to_vec(),
        (TimeUnit::Nanosecond, false) => array.as_primitive::<DurationNanosecondType>().values().to_vec(),
    }
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
