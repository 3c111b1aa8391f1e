//! Reads the doubles of a Parquet file column by column, so that a file of any length needs little memory.

use crate::columnar::BATCH_ROWS;
use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use arrow_schema::DataType;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use std::fs::File;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Passes the values of each column of doubles, in the order of the columns, in pieces. Columns of other types are
/// skipped.
pub fn parquet_doubles(file: &File, mut take: impl FnMut(&[f64])) -> io::Result<()> {
    let read = || read(file, &mut take);
    // The decoders panic on some broken files.
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| Err(io::Error::other("its parts contradict each other")))
}

fn read(file: &File, take: &mut impl FnMut(&[f64])) -> io::Result<()> {
    let open = || ParquetRecordBatchReaderBuilder::try_new(file.try_clone()?).map_err(io::Error::other);
    let schema = open()?.schema().clone();
    for (place, field) in schema.fields().iter().enumerate() {
        if field.data_type() != &DataType::Float64 {
            continue;
        }
        let builder = open()?;
        let mask = ProjectionMask::roots(builder.parquet_schema(), [place]);
        let batches = builder.with_projection(mask).with_batch_size(BATCH_ROWS).build().map_err(io::Error::other)?;
        for batch in batches {
            take(batch.map_err(io::Error::other)?.column(0).as_primitive::<Float64Type>().values());
        }
    }
    Ok(())
}
