//! Exports any table of numbers and words, such as the data of a figure, that is not a run.

use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray};
use parquet::arrow::ArrowWriter;
use std::io::{self, Write};
use std::sync::Arc;

/// One column; a value may be missing.
#[derive(Debug, Clone, PartialEq)]
pub enum TableColumn {
    Numbers(Vec<Option<f64>>),
    Words(Vec<Option<String>>),
}

/// `columns` by name, of equal length.
pub fn write_table_csv(out: impl Write, columns: &[(String, TableColumn)]) -> io::Result<()> {
    let mut out = csv::Writer::from_writer(out);
    out.write_record(columns.iter().map(|(name, _)| name))?;
    let rows = columns.first().map_or(0, |(_, column)| match column {
        TableColumn::Numbers(values) => values.len(),
        TableColumn::Words(values) => values.len(),
    });
    for row in 0..rows {
        out.write_record(columns.iter().map(|(_, column)| match column {
            TableColumn::Numbers(values) => values[row].map_or_else(String::new, |value| value.to_string()),
            TableColumn::Words(values) => values[row].clone().unwrap_or_default(),
        }))?;
    }
    out.flush()
}

/// The same as Parquet: doubles and texts; missing values stay missing.
pub fn write_table_parquet(out: impl Write + Send, columns: Vec<(String, TableColumn)>) -> io::Result<()> {
    let arrays = columns.into_iter().map(|(name, column)| {
        let array: ArrayRef = match column {
            TableColumn::Numbers(values) => Arc::new(Float64Array::from(values)),
            TableColumn::Words(values) => Arc::new(StringArray::from(values)),
        };
        (name, array, true)
    });
    let batch = RecordBatch::try_from_iter_with_nullable(arrays).map_err(io::Error::other)?;
    let mut writer = ArrowWriter::try_new(out, batch.schema(), None).map_err(io::Error::other)?;
    writer.write(&batch).map_err(io::Error::other)?;
    writer.close().map_err(io::Error::other)?;
    Ok(())
}
