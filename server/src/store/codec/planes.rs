//! Bytes of one weight together: where differences are small, all planes but the lowest are zeros, which zstd takes for
//! nothing, and the lowest holds the noise, which is what a sensor's sample really says.

use super::Broken;
use std::cell::RefCell;

/// Fast, and within a few per cent of what higher levels reach on noise.
const LEVEL: i32 = 1;

thread_local! {
    /// zstd's working memory is larger than a column: made once for each thread.
    static COMPRESSOR: RefCell<Option<zstd::bulk::Compressor<'static>>> = const { RefCell::new(None) };
    static DECOMPRESSOR: RefCell<Option<zstd::bulk::Decompressor<'static>>> = const { RefCell::new(None) };
}

#[inline(always)]
pub fn zigzag(difference: i64) -> u64 {
    ((difference << 1) ^ (difference >> 63)) as u64
}

#[inline(always)]
pub fn unzigzag(word: u64) -> i64 {
    ((word >> 1) as i64) ^ -((word & 1) as i64)
}

/// `width` planes of one byte for each row, then what else goes along.
pub struct Planes {
    rows: usize,
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
        Planes { rows, width, bytes }
    }

    pub fn width(&self) -> u8 {
        self.width as u8
    }

    /// Appends the packed planes and, behind them, `extra`.
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

    pub fn decompress(packed: &[u8], rows: usize, width: u8, with_extra: bool) -> Result<Planes, Broken> {
        let width = usize::from(width);
        if width > 8 {
            return Err(Broken);
        }
        let size = rows * (width + usize::from(with_extra));
        let bytes = DECOMPRESSOR.with_borrow_mut(|decompressor| {
            let decompressor = decompressor
                .get_or_insert_with(|| zstd::bulk::Decompressor::new().expect("zstd has memory for its tables"));
            decompressor.decompress(packed, size).map_err(|_| Broken)
        })?;
        if bytes.len() == size { Ok(Planes { rows, width, bytes }) } else { Err(Broken) }
    }

    /// What went along behind the planes.
    pub fn extra(&self) -> &[u8] {
        &self.bytes[self.rows * self.width..]
    }

    /// Appends `value` of every row's word, in order.
    #[inline(always)]
    pub fn each(&self, mut value: impl FnMut(u64) -> f64, values: &mut Vec<f64>) {
        // The narrow widths are what sensors give; each gets a loop of its own.
        match self.width {
            0 => values.extend((0..self.rows).map(|_| value(0))),
            1 => self.gather::<1>(value, values),
            2 => self.gather::<2>(value, values),
            3 => self.gather::<3>(value, values),
            4 => self.gather::<4>(value, values),
            _ => values.extend((0..self.rows).map(|row| {
                let word =
                    (0..self.width).map(|weight| u64::from(self.bytes[weight * self.rows + row]) << (8 * weight));
                value(word.fold(0, |all, byte| all | byte))
            })),
        }
    }

    #[inline(always)]
    fn gather<const WIDTH: usize>(&self, mut value: impl FnMut(u64) -> f64, values: &mut Vec<f64>) {
        let planes: [&[u8]; WIDTH] = std::array::from_fn(|weight| &self.bytes[weight * self.rows..][..self.rows]);
        values.extend((0..self.rows).map(|row| {
            let mut word = 0;
            for (weight, plane) in planes.iter().enumerate() {
                word |= u64::from(plane[row]) << (8 * weight);
            }
            value(word)
        }));
    }
}
