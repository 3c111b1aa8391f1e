//! Checks the metadata of a Parquet file before it is decoded: the positions and unpacked sizes of its columns.

use crate::Bounds;
use crate::error::FileFault;
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData};

/// Refuses chunks outside the file, and a table beyond the bounds.
pub fn check(metadata: &ParquetMetaData, file_bytes: u64, bounds: &Bounds) -> Result<(), FileFault> {
    let broken = || FileFault::Columnar("its columns do not fit the file: was it cut off?".to_owned());
    let rows = usize::try_from(metadata.file_metadata().num_rows()).map_err(|_| broken())?;
    bounds.check_rows(rows, 0)?;
    let (mut expanded, mut in_groups) = (0_u64, 0_u64);
    for group in metadata.row_groups() {
        in_groups =
            u64::try_from(group.num_rows()).ok().and_then(|rows| in_groups.checked_add(rows)).ok_or_else(broken)?;
        for chunk in group.columns() {
            let bytes = unpacked(chunk, file_bytes).ok_or_else(broken)?;
            expanded = expanded.checked_add(bytes).ok_or_else(broken)?;
        }
    }
    if in_groups != rows as u64 {
        return Err(broken());
    }
    bounds.check_expanded(expanded, Some(file_bytes))
}

/// Unpacked size of a chunk in bytes. `None` if the chunk is not inside the file.
fn unpacked(chunk: &ColumnChunkMetaData, file_bytes: u64) -> Option<u64> {
    let first = chunk.dictionary_page_offset().unwrap_or(chunk.data_page_offset()).min(chunk.data_page_offset());
    let from = u64::try_from(first).ok()?;
    let bytes = u64::try_from(chunk.compressed_size()).ok()?;
    (from.checked_add(bytes)? <= file_bytes).then(|| u64::try_from(chunk.uncompressed_size()).ok())?
}
