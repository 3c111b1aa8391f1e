//! A column as integer counts of one step. Other values are stored separately with their row.

use super::planes::{CHUNK, Planes, Unpacked, unzigzag, zigzag};
use super::{Broken, COUNTS, Reader, Scale};

/// A column with more than one exception per this number of rows is not stored as counts.
const ROWS_PER_EXCEPTION: usize = 24;

/// `None` if the scale does not reproduce the column.
pub fn pack(values: &[f64], scale: Scale) -> Option<Vec<u8>> {
    let inverse = scale.inverse();
    let mut counts = vec![0i64; values.len()];
    let mut exact = true;
    for (count, value) in counts.iter_mut().zip(values) {
        *count = scale.count(*value, inverse);
        exact &= scale.value(*count).to_bits() == value.to_bits();
    }
    // A count beyond the rounding range is accepted if it reproduces the value.
    let (corrections, exceptions) = if exact { (Vec::new(), Vec::new()) } else { repair(values, scale, &mut counts)? };

    let (kind, factor) = match scale {
        Scale::Times(step) => (0, step),
        Scale::Over(parts) => (1, parts),
    };
    let first = counts.first().copied().unwrap_or_default();
    let mut previous = first;
    let planes = Planes::of(counts.iter().map(|count| {
        let difference = count.wrapping_sub(previous);
        previous = *count;
        zigzag(difference)
    }));
    let mut packed = vec![COUNTS, kind, u8::from(!corrections.is_empty()), planes.width()];
    packed.extend_from_slice(&factor.to_le_bytes());
    packed.extend_from_slice(&first.to_le_bytes());
    packed.extend_from_slice(&(exceptions.len() as u32).to_le_bytes());
    for (row, bits) in exceptions {
        packed.extend_from_slice(&row.to_le_bytes());
        packed.extend_from_slice(&bits.to_le_bytes());
    }
    planes.compress(&corrections, &mut packed);
    Some(packed)
}

type Repair = (Vec<u8>, Vec<(u32, u64)>);

/// Corrections of the last places for all rows (empty if not needed), and the rows that are no counts.
fn repair(values: &[f64], scale: Scale, counts: &mut [i64]) -> Option<Repair> {
    let inverse = scale.inverse();
    let most = values.len() / ROWS_PER_EXCEPTION;
    let mut corrections = vec![0u8; values.len()];
    let (mut corrected, mut exceptions) = (false, Vec::new());
    for (row, value) in values.iter().enumerate() {
        match scale.misses(*value, inverse) {
            Some(miss) => {
                corrections[row] = zigzag(i64::from(miss)) as u8;
                corrected |= miss != 0;
            }
            None if exceptions.len() < most => {
                exceptions.push((row as u32, value.to_bits()));
                counts[row] = if row > 0 { counts[row - 1] } else { 0 };
            }
            None => return None,
        }
    }
    if !corrected {
        corrections.clear();
    }
    Some((corrections, exceptions))
}

pub fn unpack(mut packed: Reader<'_>, values: &mut [f64]) -> Result<(), Broken> {
    let [kind, corrected, width] = packed.take()?;
    let factor = f64::from_bits(packed.word()?);
    let first = packed.word()? as i64;
    let exceptions = packed.half()?;
    let exceptions: Vec<(usize, u64)> =
        (0..exceptions).map(|_| Ok((packed.half()? as usize, packed.word()?))).collect::<Result<_, Broken>>()?;

    Planes::decompress(packed.0, values.len(), width, corrected != 0, |planes| {
        match kind {
            0 => fill(planes, first, values, |count| Scale::Times(factor).value(count)),
            1 => fill(planes, first, values, |count| Scale::Over(factor).value(count)),
            _ => return Err(Broken),
        }
        for (value, correction) in values.iter_mut().zip(planes.extra()) {
            let miss = unzigzag(u64::from(*correction));
            *value = f64::from_bits(value.to_bits().wrapping_add(miss as u64));
        }
        for (row, bits) in exceptions {
            *values.get_mut(row).ok_or(Broken)? = f64::from_bits(bits);
        }
        Ok(())
    })
}

fn fill(planes: &Unpacked<'_>, first: i64, values: &mut [f64], value: impl Fn(i64) -> f64) {
    let mut count = first;
    let mut counts = [0i64; CHUNK];
    planes.each(values, |differences, values| {
        // Two loops: only the sums depend on each other, so the second loop can be vectorized.
        for (sum, difference) in counts.iter_mut().zip(differences) {
            count = count.wrapping_add(*difference);
            *sum = count;
        }
        for (to, count) in values.iter_mut().zip(&counts) {
            *to = value(*count);
        }
    });
}
