//! SHA-256 of a table: the values of its columns of doubles, each as eight bytes, little endian, column after column.

use crate::error::LabError;
use jointbench_files::parquet_doubles;
use ring::digest::{Context, SHA256};
use std::fs::File;

/// Values that are converted at a time.
const AT_ONCE: usize = 1024;

pub struct Digest {
    context: Context,
    bytes: Vec<u8>,
}

impl Default for Digest {
    fn default() -> Self {
        Self { context: Context::new(&SHA256), bytes: Vec::with_capacity(8 * AT_ONCE) }
    }
}

impl Digest {
    pub fn take(&mut self, values: &[f64]) {
        for values in values.chunks(AT_ONCE) {
            self.bytes.clear();
            values.iter().for_each(|value| self.bytes.extend_from_slice(&value.to_le_bytes()));
            self.context.update(&self.bytes);
        }
    }

    /// As 64 hexadecimal digits.
    pub fn hex(self) -> String {
        self.context.finish().as_ref().iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// The digest of a Parquet file.
    ///
    /// # Errors
    /// [`LabError::Conflict`] if the file cannot be read as a table.
    pub fn of_file(file: &File, path: &str) -> Result<String, LabError> {
        let mut digest = Self::default();
        parquet_doubles(file, |values| digest.take(values))
            .map_err(|fault| LabError::Conflict(format!("{path} in the archive cannot be read ({fault})")))?;
        Ok(digest.hex())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_files::{Annotations, ParquetWriter};
    use jointbench_instrument::{Channel, Meta, Trace};

    /// `hashlib.sha256(struct.pack("<3d", 1.0, -0.0, math.nan))`, with the NaN 0x7ff8000000000000.
    const KNOWN: &str = "14364be8d4d6945bdd6f182b716388921779aeb8ca4fa28b250bba34a8f79c28";

    #[test]
    fn the_digest_is_that_of_other_programs() {
        let mut digest = Digest::default();
        digest.take(&[1.0, -0.0]);
        digest.take(&[f64::from_bits(0x7ff8_0000_0000_0000)]);
        assert_eq!(digest.hex(), KNOWN);
    }

    #[test]
    fn a_file_has_the_digest_of_its_columns_and_a_changed_bit_shows() {
        let values: Vec<f64> = (0..200_000).map(|row| f64::from(row % 7777).sqrt()).collect();
        let written = |first: f64| {
            let mut columns = vec![values.clone(), values.iter().rev().copied().collect()];
            columns[1][0] = first;
            let mut digest = Digest::default();
            columns.iter().for_each(|column| digest.take(column));
            let channels = ["time_s", "motor_current_a"].map(Channel::new).to_vec();
            let trace = Trace::from_columns(channels, columns);
            let file = tempfile::tempfile().unwrap();
            let labels = vec![("serial", Some("SN7".to_owned())), ("procedure", None)];
            let more = Annotations { labels, ..Annotations::default() };
            let out = file.try_clone().unwrap();
            let mut parquet = ParquetWriter::annotated(out, &Meta::default(), trace.channels(), more).unwrap();
            parquet.write(&trace).unwrap();
            parquet.finish().unwrap();
            (digest.hex(), Digest::of_file(&file, "x").unwrap())
        };
        let (expected, found) = written(3.0);
        assert_eq!(found, expected);
        assert_ne!(written(f64::from_bits(3.0_f64.to_bits() + 1)).1, expected);
    }

    #[test]
    fn a_file_that_is_no_table_is_a_conflict() {
        let path = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(path.path(), b"PAR1 and nothing else PAR1").unwrap();
        let fault = Digest::of_file(&File::open(path.path()).unwrap(), "samples/x").unwrap_err();
        assert!(matches!(&fault, LabError::Conflict(why) if why.starts_with("samples/x")), "{fault:?}");
    }
}
