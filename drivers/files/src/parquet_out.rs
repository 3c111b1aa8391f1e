//! Parquet out: one double column for each channel, the facts embedded.

use crate::facts::{EMBEDDED, meta_json};
use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_schema::{DataType, Field, Schema};
use jointbench_instrument::{Meta, Trace};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, ZstdLevel};
use parquet::file::properties::WriterProperties;
use std::collections::HashMap;
use std::io::{self, Write};
use std::sync::Arc;

pub fn write_parquet(out: impl Write + Send, meta: &Meta, trace: &Trace) -> io::Result<()> {
    let fields: Vec<Field> = trace.channels().iter().map(|c| Field::new(&c.name, DataType::Float64, false)).collect();
    let facts = HashMap::from([(EMBEDDED.to_owned(), meta_json(meta, trace.channels()))]);
    let schema = Arc::new(Schema::new_with_metadata(fields, facts));
    let columns: Vec<ArrayRef> = trace
        .columns()
        .iter()
        .map(|c| Arc::new(Float64Array::from_iter_values(c.iter().copied())) as ArrayRef)
        .collect();
    let batch = RecordBatch::try_new(schema.clone(), columns).map_err(io::Error::other)?;
    let level = ZstdLevel::try_new(3).map_err(io::Error::other)?;
    let properties = WriterProperties::builder().set_compression(Compression::ZSTD(level)).build();
    let mut writer = ArrowWriter::try_new(out, schema, Some(properties)).map_err(io::Error::other)?;
    writer.write(&batch).map_err(io::Error::other)?;
    writer.close().map_err(io::Error::other)?;
    Ok(())
}
