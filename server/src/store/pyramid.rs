//! Overview of a block: smallest and largest value of bins of rows. A plot of any run has the same cost, and a spike of
//! one sample remains visible.

use super::codec::{self, Broken};

/// Rows of a fine bin. Fine bins are packed like samples.
pub const FINE_ROWS: usize = 64;
/// Rows of a coarse bin. Coarse bins are plain doubles, because a plot of a long run reads hundreds of them.
pub const COARSE_ROWS: usize = 1024;

/// Smallest and largest values of consecutive bins.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Extremes {
    pub min: Vec<f64>,
    pub max: Vec<f64>,
}

impl Extremes {
    /// A bin that is empty or contains only NaN arrives as (∞, −∞) and is stored as NaN.
    pub fn push(&mut self, min: f64, max: f64) {
        let empty = min > max;
        self.min.push(if empty { f64::NAN } else { min });
        self.max.push(if empty { f64::NAN } else { max });
    }
}

/// Smallest and largest value of each bin of `width` rows.
pub fn extremes(values: &[f64], width: usize) -> Extremes {
    let bins = values.len().div_ceil(width);
    let mut found = Extremes { min: Vec::with_capacity(bins), max: Vec::with_capacity(bins) };
    for bin in values.chunks(width) {
        // A comparison with NaN is false, so NaN is ignored.
        let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in bin {
            min = if *value < min { *value } else { min };
            max = if *value > max { *value } else { max };
        }
        found.push(min, max);
    }
    found
}

/// Combines `times` bins into one.
pub fn widen(fine: &Extremes, times: usize) -> Extremes {
    let mut wide = Extremes::default();
    for (min, max) in fine.min.chunks(times).zip(fine.max.chunks(times)) {
        wide.push(min.iter().copied().fold(f64::NAN, f64::min), max.iter().copied().fold(f64::NAN, f64::max));
    }
    wide
}

/// All channels of a block in sequence; for each channel all minima, then all maxima.
pub fn pack_coarse(channels: &[Extremes]) -> Vec<u8> {
    let values = channels.iter().flat_map(|channel| channel.min.iter().chain(&channel.max));
    values.flat_map(|value| value.to_le_bytes()).collect()
}

/// The channel at index `place` of a block of `rows`.
pub fn unpack_coarse(packed: &[u8], rows: usize, place: usize) -> Result<Extremes, Broken> {
    let bins = rows.div_ceil(COARSE_ROWS);
    let bytes = packed.get(place * bins * 16..(place + 1) * bins * 16).ok_or(Broken)?;
    let read = |bytes: &[u8]| bytes.as_chunks::<8>().0.iter().map(|word| f64::from_le_bytes(*word)).collect();
    let (min, max) = bytes.split_at(bins * 8);
    Ok(Extremes { min: read(min), max: read(max) })
}

/// All channels of a block, each packed and preceded by its length.
pub fn pack_fine(channels: &[Extremes], resolutions: &[Option<f64>]) -> Vec<u8> {
    let columns: Vec<Vec<f64>> = channels.iter().map(|channel| [&channel.min[..], &channel.max].concat()).collect();
    pack_columns(&columns, resolutions)
}

pub fn unpack_fine(packed: &[u8], rows: usize, place: usize) -> Result<Extremes, Broken> {
    let bins = rows.div_ceil(FINE_ROWS);
    let mut values = vec![0.0; 2 * bins];
    unpack_column(packed, place, &mut values)?;
    let max = values.split_off(bins);
    Ok(Extremes { min: values, max })
}

/// Several columns in one byte string, each preceded by its length.
pub fn pack_columns(columns: &[impl AsRef<[f64]>], resolutions: &[Option<f64>]) -> Vec<u8> {
    let mut piece = Vec::new();
    for (column, resolution) in columns.iter().zip(resolutions) {
        let packed = codec::pack(column.as_ref(), *resolution);
        piece.extend_from_slice(&(packed.len() as u32).to_le_bytes());
        piece.extend_from_slice(&packed);
    }
    piece
}

/// Fills `values` with the column at index `place` of the result of [`pack_columns`].
pub fn unpack_column(piece: &[u8], place: usize, values: &mut [f64]) -> Result<(), Broken> {
    let mut rest = piece;
    for at in 0.. {
        let (length, behind) = rest.split_first_chunk::<4>().ok_or(Broken)?;
        let (column, behind) = behind.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or(Broken)?;
        if at == place {
            return codec::unpack(column, values);
        }
        rest = behind;
    }
    Err(Broken)
}
