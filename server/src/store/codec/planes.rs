//! Byte planes: one plane for each byte of the differences. For small differences all planes but the lowest are zeros,
//! which zstd compresses to almost nothing. The lowest plane holds the noise of the sensor.

use super::Broken;
use std::cell::RefCell;

/// Fast; on noise the result is within a few per cent of higher levels.
const LEVEL: i32 = 1;

thread_local! {
    /// The working memory of zstd is larger than a column, so each thread creates it once.
    static COMPRESSOR: RefCell<Option<zstd::bulk::Compressor<'static>>> = const { RefCell::new(None) };
    static DECOMPRESSOR: RefCell<(Option<zstd::bulk::Decompressor<'static>>, Vec<u8>)> =
        const { RefCell::new((None, Vec::new())) };
}

#[inline(always)]
pub fn zigzag(difference: i64) -> u64 {
    ((difference << 1) ^ (difference >> 63)) as u64
}

#[inline(always)]
pub fn unzigzag(word: u64) -> i64 {
    ((word >> 1) as i64) ^ -((word & 1) as i64)
}

/// `width` planes of one byte for each row, then extra bytes.
pub struct Planes {
    width: usize,
    bytes: Vec<u8>,
}

impl Planes {
    pub fn of(words: impl Iterator<Item = u64>) -> Planes {
        let words: Vec<u64> = words.collect();
        let widest = words.iter().fold(0, |all, word| all | word);
        let width = (8 - widest.leading_zeros() as usize / 8).min(8);
        let rows = words.len();
        let mut bytes = vec![0u8; rows * width];
        for (weight, plane) in bytes.chunks_exact_mut(rows.max(1)).enumerate() {
            for (byte, word) in plane.iter_mut().zip(&words) {
                *byte = (word >> (8 * weight)) as u8;
            }
        }
        Planes { width, bytes }
    }

    pub fn width(&self) -> u8 {
        self.width as u8
    }

    /// Appends the packed planes, followed by `extra`.
    pub fn compress(mut self, extra: &[u8], packed: &mut Vec<u8>) {
        self.bytes.extend_from_slice(extra);
        let start = packed.len();
        packed.resize(start + zstd::zstd_safe::compress_bound(self.bytes.len()), 0);
        let size = COMPRESSOR.with_borrow_mut(|compressor| {
            let compressor =
                compressor.get_or_insert_with(|| zstd::bulk::Compressor::new(LEVEL).expect("zstd has this level"));
            compressor.compress_to_buffer(&self.bytes, &mut packed[start..]).expect("the buffer holds the worst case")
        });
        packed.truncate(start + size);
    }

    /// Passes the planes to `read`. They are in memory that the next column of this thread reuses.
    pub fn decompress<T>(
        packed: &[u8],
        rows: usize,
        width: u8,
        with_extra: bool,
        read: impl FnOnce(&Unpacked<'_>) -> Result<T, Broken>,
    ) -> Result<T, Broken> {
        let width = usize::from(width);
        if width > 8 {
            return Err(Broken);
        }
        let size = rows * (width + usize::from(with_extra));
        DECOMPRESSOR.with_borrow_mut(|(decompressor, bytes)| {
            let decompressor = decompressor
                .get_or_insert_with(|| zstd::bulk::Decompressor::new().expect("zstd has memory for its tables"));
            bytes.resize(size, 0);
            match decompressor.decompress_to_buffer(packed, &mut bytes[..]) {
                Ok(length) if length == size => read(&Unpacked { rows, width, bytes }),
                _ => Err(Broken),
            }
        })
    }
}

/// Planes during decompression.
pub struct Unpacked<'a> {
    rows: usize,
    width: usize,
    bytes: &'a [u8],
}

/// Rows that are assembled at a time: they fit into the first-level cache.
pub const CHUNK: usize = 256;

impl Unpacked<'_> {
    /// The bytes after the planes.
    pub fn extra(&self) -> &[u8] {
        &self.bytes[self.rows * self.width..]
    }

    /// Passes the differences of consecutive rows and the slice for their values to `take`.
    #[inline(always)]
    pub fn each(&self, values: &mut [f64], mut take: impl FnMut(&[i64], &mut [f64])) {
        let mut differences = [0i64; CHUNK];
        for (chunk, values) in values.chunks_mut(CHUNK).enumerate() {
            let differences = &mut differences[..values.len()];
            let from = chunk * CHUNK;
            // Sensors produce narrow widths: each has its own loop with constant shifts.
            match self.width {
                1 => self.gather::<1>(from, differences),
                2 => self.gather::<2>(from, differences),
                3 => self.gather::<3>(from, differences),
                width => self.gather_wide(width, from, differences),
            }
            take(differences, values);
        }
    }

    #[inline(always)]
    fn gather<const WIDTH: usize>(&self, from: usize, differences: &mut [i64]) {
        let planes: [&[u8]; WIDTH] =
            std::array::from_fn(|weight| &self.bytes[weight * self.rows + from..][..differences.len()]);
        for (row, difference) in differences.iter_mut().enumerate() {
            let word =
                planes.iter().enumerate().fold(0, |word, (weight, plane)| word | u32::from(plane[row]) << (8 * weight));
            *difference = i64::from((word >> 1) as i32 ^ -((word & 1) as i32));
        }
    }

    fn gather_wide(&self, width: usize, from: usize, differences: &mut [i64]) {
        for (row, difference) in differences.iter_mut().enumerate() {
            let byte = |weight: usize| u64::from(self.bytes[weight * self.rows + from + row]) << (8 * weight);
            *difference = unzigzag((0..width).fold(0, |word, weight| word | byte(weight)));
        }
    }
}
