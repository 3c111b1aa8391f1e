//! Exports Parquet: one column of doubles per channel, with embedded facts.

use crate::facts::{EMBEDDED, meta_json};
use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_schema::{DataType, Field, Schema};
use jointbench_instrument::{Channel, Meta, Trace};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, ZstdLevel};
use parquet::file::properties::WriterProperties;
use std::collections::HashMap;
use std::io::{self, Write};
use std::sync::Arc;

pub fn write_parquet(out: impl Write + Send, meta: &Meta, trace: &Trace) -> io::Result<()> {
    let mut parquet = ParquetWriter::new(out, meta, trace.channels())?;
    parquet.write(trace)?;
    parquet.finish()
}

/// Writes a Parquet file block by block.
pub struct ParquetWriter<W: Write + Send> {
    writer: ArrowWriter<W>,
    schema: Arc<Schema>,
}

impl<W: Write + Send> ParquetWriter<W> {
    /// `channels` are the same for every block.
    pub fn new(out: W, meta: &Meta, channels: &[Channel]) -> io::Result<Self> {
        let fields: Vec<Field> = channels.iter().map(|c| Field::new(&c.name, DataType::Float64, false)).collect();
        let facts = HashMap::from([(EMBEDDED.to_owned(), meta_json(meta, channels))]);
        let schema = Arc::new(Schema::new_with_metadata(fields, facts));
        let level = ZstdLevel::try_new(3).map_err(io::Error::other)?;
        let properties = WriterProperties::builder().set_compression(Compression::ZSTD(level)).build();
        let writer = ArrowWriter::try_new(out, schema.clone(), Some(properties)).map_err(io::Error::other)?;
        Ok(Self { writer, schema })
    }

    pub fn write(&mut self, trace: &Trace) -> io::Result<()> {
        let array = |c: &Vec<f64>| Arc::new(Float64Array::from_iter_values(c.iter().copied())) as ArrayRef;
        let columns: Vec<ArrayRef> = trace.columns().iter().map(array).collect();
        let batch = RecordBatch::try_new(self.schema.clone(), columns).map_err(io::Error::other)?;
        self.writer.write(&batch).map_err(io::Error::other)
    }

    pub fn finish(self) -> io::Result<()> {
        self.writer.close().map_err(io::Error::other)?;
        Ok(())
    }
}
