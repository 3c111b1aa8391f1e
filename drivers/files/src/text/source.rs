//! The bytes of a text, plain or packed, in pieces of whole lines.

use super::encoding::{Coding, decode};
use crate::Bounds;
use crate::error::FileFault;
use encoding_rs::Decoder;
use flate2::read::MultiGzDecoder;
use std::io::{self, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes from a file, a packed file or memory.
pub trait Source: Send {
    fn read(&mut self, room: &mut [u8]) -> Result<usize, FileFault>;
}

pub struct Plain<R>(pub R);

impl<R: Read + Send> Source for Plain<R> {
    fn read(&mut self, room: &mut [u8]) -> Result<usize, FileFault> {
        loop {
            match self.0.read(room) {
                Err(fault) if fault.kind() == io::ErrorKind::Interrupted => {}
                read => return read.map_err(FileFault::Io),
            }
        }
    }
}

/// A gzip file, unpacked within bounds.
pub struct Packed<R> {
    inner: MultiGzDecoder<Counted<R>>,
    packed: Arc<AtomicU64>,
    unpacked: u64,
    bounds: Bounds,
}

struct Counted<R> {
    inner: R,
    count: Arc<AtomicU64>,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(room)?;
        self.count.fetch_add(read as u64, Ordering::Relaxed);
        Ok(read)
    }
}

impl<R: Read> Packed<R> {
    pub fn new(inner: R, bounds: Bounds) -> Self {
        let packed = Arc::<AtomicU64>::default();
        let inner = MultiGzDecoder::new(Counted { inner, count: packed.clone() });
        Self { inner, packed, unpacked: 0, bounds }
    }
}

impl<R: Read + Send> Source for Packed<R> {
    fn read(&mut self, room: &mut [u8]) -> Result<usize, FileFault> {
        let read = self.inner.read(room).map_err(|fault| FileFault::Gzip(fault.to_string()))?;
        self.unpacked += read as u64;
        self.bounds.check_expanded(self.unpacked, Some(self.packed.load(Ordering::Relaxed)))?;
        Ok(read)
    }
}

/// Size of a piece in bytes.
const PIECE_BYTES: usize = 4 << 20;
/// After this many bytes without a line end, quotation marks are ignored.
const LONGEST_LINE: usize = 64 << 20;

/// A text in pieces of whole lines, in UTF-8.
pub struct Pieces<'s> {
    source: &'s mut dyn Source,
    decoder: Option<Decoder>,
    /// Decoded bytes that were read but not returned yet.
    rest: Vec<u8>,
    is_over: bool,
    bytes: usize,
    /// Line ends of old systems: only CR.
    is_cr: bool,
    /// Bytes to skip at the beginning.
    mark: usize,
    pub coding: Option<Coding>,
}

impl<'s> Pieces<'s> {
    pub fn new(source: &'s mut dyn Source) -> Self {
        Self {
            source,
            decoder: None,
            rest: Vec::new(),
            is_over: false,
            bytes: PIECE_BYTES,
            is_cr: false,
            mark: 0,
            coding: None,
        }
    }

    /// Reads until `wanted` bytes are available or the text ends.
    fn fill(&mut self, wanted: usize) -> Result<(), FileFault> {
        let mut room = vec![0; self.bytes.min(1 << 20)];
        while !self.is_over && self.rest.len() < wanted {
            let read = self.source.read(&mut room)?;
            self.is_over = read == 0;
            if self.coding.is_none() {
                self.begin(&room[..read])?;
            }
            let piece = &room[self.mark.min(read)..read];
            self.mark = 0;
            match &mut self.decoder {
                Some(decoder) => decode(decoder, piece, self.is_over, &mut self.rest),
                None => self.rest.extend_from_slice(piece),
            }
        }
        Ok(())
    }

    fn begin(&mut self, first: &[u8]) -> Result<(), FileFault> {
        let coding = Coding::of(first)?;
        self.decoder = coding.decoder();
        self.mark = coding.mark;
        self.coding = Some(coding);
        Ok(())
    }

    /// The next lines, and whether they are the last. `None` after the last.
    pub fn next(&mut self) -> Result<Option<(Vec<u8>, bool)>, FileFault> {
        let is_first = self.coding.is_none();
        self.fill(self.bytes)?;
        if is_first {
            self.is_cr = !self.rest.contains(&b'\n') && self.rest.contains(&b'\r');
        }
        if self.rest.is_empty() {
            return Ok(None);
        }
        let mut wanted = self.bytes;
        let end = loop {
            if self.is_over {
                break self.rest.len();
            }
            match cut(&self.rest, self.is_cr, wanted >= LONGEST_LINE) {
                Some(end) => break end,
                None => {
                    wanted *= 2;
                    self.fill(wanted)?;
                }
            }
        };
        let after = self.rest.split_off(end);
        let mut piece = std::mem::replace(&mut self.rest, after);
        if self.is_cr {
            piece.iter_mut().filter(|byte| **byte == b'\r').for_each(|byte| *byte = b'\n');
        }
        let is_last = self.is_over && self.rest.is_empty();
        Ok(Some((piece, is_last)))
    }

    /// The next pieces, at most `most`; empty after the last piece.
    pub fn batch(&mut self, most: usize) -> Result<Vec<(Vec<u8>, bool)>, FileFault> {
        let mut batch = Vec::new();
        while batch.len() < most
            && let Some(piece) = self.next()?
        {
            batch.push(piece);
        }
        Ok(batch)
    }
}

/// Position after the last line end that is not inside quotation marks.
fn cut(text: &[u8], is_cr: bool, without_marks: bool) -> Option<usize> {
    let end = if is_cr { b'\r' } else { b'\n' };
    let last = text.iter().rposition(|byte| *byte == end)?;
    let marks = if without_marks { 0 } else { text[..last].iter().filter(|byte| **byte == b'"').count() };
    if marks % 2 == 0 {
        return Some(last + 1);
    }
    // The open quotation mark is the last one.
    let open = text[..last].iter().rposition(|byte| *byte == b'"')?;
    text[..open].iter().rposition(|byte| *byte == end).map(|at| at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pieces(text: &[u8], bytes: usize) -> Vec<Vec<u8>> {
        let mut source = Plain(text);
        let mut pieces = Pieces { bytes, ..Pieces::new(&mut source) };
        let mut all = Vec::new();
        while let Some((piece, is_last)) = pieces.next().unwrap() {
            all.push(piece);
            assert_eq!(is_last, all.concat().len() == text.len());
        }
        all
    }

    #[test]
    fn pieces_end_with_lines() {
        let text = b"a,b\n1,\"x\ny\"\n2,3\n4,5".as_slice();
        for bytes in [4, 5, 8, 13, 100] {
            let all = pieces(text, bytes);
            assert_eq!(all.concat(), text);
            assert!(all[..all.len() - 1].iter().all(|piece| piece.ends_with(b"\n")), "{bytes}");
            assert!(all.iter().all(|piece| piece.iter().filter(|b| **b == b'"').count() % 2 == 0), "{bytes}");
        }
        assert_eq!(pieces(b"a\rb\r", 100), [b"a\nb\n"]);
        assert_eq!(pieces(b"", 100), Vec::<Vec<u8>>::new());
    }
}
