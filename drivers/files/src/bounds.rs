//! Limits for the import of a file: a few kilobytes can unpack to more than the memory of any computer.

use crate::error::FileFault;

/// Bounds of an imported table. A larger table is refused with the bound and a remedy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bounds {
    pub rows: usize,
    pub columns: usize,
    /// Bytes of unpacked text, of decompressed buffers, and of the table as doubles.
    pub expanded_bytes: u64,
    /// Bytes of one cell of a CSV.
    pub cell_bytes: usize,
    /// Bytes of the name of a column.
    pub name_bytes: usize,
}

/// No table of measurements compresses better, because at least its time changes with every row. Gzip compresses zeros
/// by a factor of about 1000.
const MOST_RATIO: u64 = 200;
/// Below this size a high compression ratio is harmless.
const HARMLESS_BYTES: u64 = 256 << 20;

impl Bounds {
    /// For an uploaded file.
    pub const UPLOADED: Bounds =
        Bounds { rows: 50_000_000, columns: 512, expanded_bytes: 4 << 30, cell_bytes: 4096, name_bytes: 256 };

    pub(crate) fn check_columns(&self, names: &[String]) -> Result<(), FileFault> {
        if names.len() > self.columns {
            let (found, most) = (names.len(), self.columns);
            return Err(FileFault::Bound(format!(
                "{found} columns: at most {most} are read. Write the ones that are needed to a file of their own"
            )));
        }
        match names.iter().find(|name| name.len() > self.name_bytes) {
            Some(name) => {
                let (begin, most) = (name.chars().take(20).collect::<String>(), self.name_bytes);
                Err(FileFault::Bound(format!(
                    "the column name “{begin}…” has {} bytes: at most {most} are read. Give it a shorter one",
                    name.len()
                )))
            }
            None => Ok(()),
        }
    }

    /// `columns`: the columns that are read.
    pub(crate) fn check_rows(&self, rows: usize, columns: usize) -> Result<(), FileFault> {
        if rows > self.rows {
            let most = self.rows;
            return Err(FileFault::Bound(format!("more than {most} rows: split the file, or keep every second row")));
        }
        self.check_expanded(rows as u64 * columns as u64 * size_of::<f64>() as u64, None)
    }

    pub(crate) fn check_cell(&self, bytes: usize) -> Result<(), FileFault> {
        match bytes > self.cell_bytes {
            true => Err(FileFault::Bound(format!(
                "a cell of {bytes} bytes: at most {} are read. Is a quotation mark open?",
                self.cell_bytes
            ))),
            false => Ok(()),
        }
    }

    /// `packed`: the packed size, if the bytes were packed.
    pub(crate) fn check_expanded(&self, bytes: u64, packed: Option<u64>) -> Result<(), FileFault> {
        let cure = "split the file, leave columns out, or keep every second row";
        if bytes > self.expanded_bytes {
            let most = self.expanded_bytes >> 20;
            return Err(FileFault::Bound(format!("it unpacks to more than {most} MiB: {cure}")));
        }
        match packed {
            Some(packed) if bytes > HARMLESS_BYTES && bytes / packed.max(1) > MOST_RATIO => Err(FileFault::Bound(
                format!("it unpacks to more than {MOST_RATIO} times its size, as no measurement does: {cure}"),
            )),
            _ => Ok(()),
        }
    }
}

impl Default for Bounds {
    /// For the user's own file: the memory of a large computer.
    fn default() -> Self {
        Bounds { rows: 1_000_000_000, columns: 4096, expanded_bytes: 64 << 30, cell_bytes: 1 << 16, name_bytes: 1024 }
    }
}
