//! Writes an Arrow stream: one column of doubles per channel, with embedded facts.

use crate::parquet_out::{batch, schema};
use arrow_ipc::writer::StreamWriter;
use arrow_schema::Schema;
use jointbench_instrument::{Channel, Meta, Trace};
use std::io::{self, Write};
use std::sync::Arc;

/// Writes the Arrow IPC streaming format, one record batch for each block of rows. Nothing is kept in memory.
pub struct ArrowWriter<W: Write> {
    writer: StreamWriter<W>,
    schema: Arc<Schema>,
}

impl<W: Write> ArrowWriter<W> {
    /// `channels` are the same for every block.
    pub fn new(out: W, meta: &Meta, channels: &[Channel]) -> io::Result<Self> {
        let schema = schema(meta, channels, &[]);
        let writer = StreamWriter::try_new(out, &schema).map_err(io::Error::other)?;
        Ok(Self { writer, schema })
    }

    /// Writes a block as one record batch.
    pub fn write(&mut self, trace: &Trace) -> io::Result<()> {
        self.writer.write(&batch(&self.schema, trace, &[])?).map_err(io::Error::other)
    }

    /// Writes the end of the stream.
    pub fn finish(mut self) -> io::Result<()> {
        self.writer.finish().map_err(io::Error::other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arrow_array::cast::AsArray;
    use arrow_array::types::Float64Type;
    use arrow_ipc::reader::StreamReader;

    #[test]
    fn each_block_is_a_record_batch() {
        let channels = vec![Channel::new("time_s"), Channel::new("motor_current_a")];
        let mut bytes = Vec::new();
        let mut arrow = ArrowWriter::new(&mut bytes, &Meta::default(), &channels).unwrap();
        for first in [0.0, 1.0] {
            let block = Trace::from_columns(channels.clone(), vec![vec![first, first + 0.5], vec![0.25, -0.25]]);
            arrow.write(&block).unwrap();
        }
        arrow.finish().unwrap();
        let reader = StreamReader::try_new(bytes.as_slice(), None).unwrap();
        let batches: Vec<_> = reader.map(Result::unwrap).collect();
        let times = |i: usize| batches[i].column(0).as_primitive::<Float64Type>().values().to_vec();
        assert_eq!((batches.len(), times(0), times(1)), (2, vec![0.0, 0.5], vec![1.0, 1.5]));
        assert_eq!(batches[0].schema().field(1).name(), "motor_current_a");
    }
}
