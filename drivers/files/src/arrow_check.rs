//! Checks an Arrow file before it is decoded. The lengths in the file determine the memory that its decoder allocates,
//! and some of them the read position. Source: "Arrow Columnar Format", IPC file format,
//! arrow.apache.org/docs/format/Columnar.html.

use crate::Bounds;
use crate::error::FileFault;
use arrow_ipc::{Block, Buffer, Footer, RecordBatch, root_as_footer, root_as_message};

/// Footer length and magic number at the end of a file.
const TRAILER_BYTES: usize = 10;
/// Marks the start of a message, before its length.
const CONTINUATION: [u8; 4] = [0xff; 4];
/// Uncompressed length before a compressed buffer; −1 for a buffer that is not compressed.
const LENGTH_BYTES: usize = 8;

/// Refuses lengths that exceed the file or point outside it, and tables beyond the bounds.
pub fn check(file: &[u8], bounds: &Bounds) -> Result<(), FileFault> {
    let footer = footer(file).ok_or_else(|| broken("its footer"))?;
    let batches = footer.recordBatches().into_iter().flatten();
    let dictionaries = footer.dictionaries().into_iter().flatten();
    let (mut rows, mut expanded) = (0_u64, 0_u64);
    for (block, is_dictionary) in batches.map(|block| (block, false)).chain(dictionaries.map(|block| (block, true))) {
        let Found { rows: more, expanded: bytes } = batch(file, block).ok_or_else(|| broken("a record batch"))?;
        expanded = expanded.saturating_add(bytes);
        if !is_dictionary {
            rows = rows.saturating_add(more);
        }
        bounds.check_rows(usize::try_from(rows).unwrap_or(usize::MAX), 0)?;
        bounds.check_expanded(expanded, Some(file.len() as u64))?;
    }
    Ok(())
}

fn broken(what: &str) -> FileFault {
    FileFault::Columnar(format!("{what} does not fit the file: was it cut off, or is it still being written?"))
}

fn footer(file: &[u8]) -> Option<Footer<'_>> {
    let (begin, trailer) = file.split_at_checked(file.len().checked_sub(TRAILER_BYTES)?)?;
    let length = i32::from_le_bytes(*trailer.first_chunk()?);
    let from = begin.len().checked_sub(usize::try_from(length).ok()?)?;
    root_as_footer(&begin[from..]).ok()
}

struct Found {
    rows: u64,
    expanded: u64,
}

fn batch(file: &[u8], block: &Block) -> Option<Found> {
    let offset = usize::try_from(block.offset()).ok()?;
    let (_, from) = file.split_at_checked(offset)?;
    let (head, from) = from.split_at_checked(usize::try_from(block.metaDataLength()).ok()?)?;
    let (body, _) = from.split_at_checked(usize::try_from(block.bodyLength()).ok()?)?;
    let (begin, rest) = head.split_first_chunk::<4>()?;
    let message = if *begin == CONTINUATION { rest.get(4..)? } else { rest };
    let message = root_as_message(message).ok()?;
    let batch = match message.header_as_dictionary_batch() {
        Some(dictionary) => dictionary.data()?,
        None => message.header_as_record_batch()?,
    };
    Some(Found { rows: u64::try_from(batch.length()).ok()?, expanded: expanded(batch, body)? })
}

/// Total unpacked size of the buffers of a batch. A batch without compression is read in place.
fn expanded(batch: RecordBatch<'_>, body: &[u8]) -> Option<u64> {
    let mut all = 0_u64;
    for buffer in batch.buffers()? {
        let bytes = bytes_of(buffer, body)?;
        let plain = bytes.len() as u64;
        let unpacked = match (batch.compression(), bytes.first_chunk::<LENGTH_BYTES>()) {
            (None, _) => plain,
            (Some(_), None) if bytes.is_empty() => 0,
            (Some(_), None) => return None,
            (Some(_), Some(length)) => match i64::from_le_bytes(*length) {
                -1 => plain,
                length => u64::try_from(length).ok()?,
            },
        };
        all = all.checked_add(unpacked)?;
    }
    Some(all)
}

fn bytes_of<'b>(buffer: &Buffer, body: &'b [u8]) -> Option<&'b [u8]> {
    let from = usize::try_from(buffer.offset()).ok()?;
    body.get(from..from.checked_add(usize::try_from(buffer.length()).ok()?)?)
}
