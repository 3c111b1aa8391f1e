//! Exports Parquet: one column of doubles per channel, with embedded facts.

use crate::facts::{EMBEDDED, meta_json};
use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray};
use arrow_schema::{DataType, Field, Schema};
use jointbench_instrument::{Channel, Meta, Trace};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, ZstdLevel};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use std::collections::HashMap;
use std::io::{self, Write};
use std::sync::Arc;

pub fn write_parquet(out: impl Write + Send, meta: &Meta, trace: &Trace) -> io::Result<()> {
    let mut parquet = ParquetWriter::new(out, meta, trace.channels())?;
    parquet.write(trace)?;
    parquet.finish()
}

/// What a file contains in addition to the run table.
#[derive(Debug, Clone, Default)]
pub struct Annotations {
    /// Keys and values in the footer.
    pub footer: Vec<(&'static str, String)>,
    /// Columns of text with the same value in each row.
    pub labels: Vec<(&'static str, Option<String>)>,
}

/// Writes a Parquet file block by block.
pub struct ParquetWriter<W: Write + Send> {
    writer: ArrowWriter<W>,
    schema: Arc<Schema>,
    labels: Vec<Option<String>>,
}

impl<W: Write + Send> ParquetWriter<W> {
    /// `channels` are the same for every block.
    pub fn new(out: W, meta: &Meta, channels: &[Channel]) -> io::Result<Self> {
        Self::annotated(out, meta, channels, Annotations::default())
    }

    pub fn annotated(out: W, meta: &Meta, channels: &[Channel], more: Annotations) -> io::Result<Self> {
        let names: Vec<&str> = more.labels.iter().map(|(name, _)| *name).collect();
        let schema = schema(meta, channels, &names);
        let level = ZstdLevel::try_new(3).map_err(io::Error::other)?;
        let footer = more.footer.into_iter().map(|(key, value)| KeyValue::new(key.to_owned(), value)).collect();
        let properties = WriterProperties::builder().set_compression(Compression::ZSTD(level));
        let properties = properties.set_key_value_metadata(Some(footer)).build();
        let writer = ArrowWriter::try_new(out, schema.clone(), Some(properties)).map_err(io::Error::other)?;
        Ok(Self { writer, schema, labels: more.labels.into_iter().map(|(_, value)| value).collect() })
    }

    pub fn write(&mut self, trace: &Trace) -> io::Result<()> {
        self.writer.write(&batch(&self.schema, trace, &self.labels)?).map_err(io::Error::other)
    }

    pub fn finish(self) -> io::Result<()> {
        self.writer.close().map_err(io::Error::other)?;
        Ok(())
    }
}

/// A column of doubles for each channel, then the columns of text; the facts are its metadata.
pub(crate) fn schema(meta: &Meta, channels: &[Channel], labels: &[&str]) -> Arc<Schema> {
    let numbers = channels.iter().map(|c| Field::new(&c.name, DataType::Float64, false));
    let texts = labels.iter().map(|name| Field::new(*name, DataType::Utf8, true));
    let fields: Vec<Field> = numbers.chain(texts).collect();
    let facts = HashMap::from([(EMBEDDED.to_owned(), meta_json(meta, channels))]);
    Arc::new(Schema::new_with_metadata(fields, facts))
}

/// A block of rows, with the same text in each row of a column of text.
pub(crate) fn batch(schema: &Arc<Schema>, trace: &Trace, labels: &[Option<String>]) -> io::Result<RecordBatch> {
    let array = |c: &Vec<f64>| Arc::new(Float64Array::from_iter_values(c.iter().copied())) as ArrayRef;
    let label = |value: &Option<String>| {
        Arc::new(std::iter::repeat_n(value.as_deref(), trace.len()).collect::<StringArray>()) as ArrayRef
    };
    let columns: Vec<ArrayRef> = trace.columns().iter().map(array).chain(labels.iter().map(label)).collect();
    RecordBatch::try_new(schema.clone(), columns).map_err(io::Error::other)
}
