//! A column as bit patterns, for values that no step explains.

use super::planes::{Planes, unzigzag, zigzag};
use super::{BITS, Broken, Reader};

pub fn pack(values: &[f64]) -> Vec<u8> {
    let first = values.first().map_or(0, |value| value.to_bits());
    let mut previous = first;
    let planes = Planes::of(values.iter().map(|value| {
        let difference = value.to_bits().wrapping_sub(previous) as i64;
        previous = value.to_bits();
        zigzag(difference)
    }));
    let mut packed = vec![BITS, planes.width()];
    packed.extend_from_slice(&first.to_le_bytes());
    planes.compress(&[], &mut packed);
    packed
}

pub fn unpack(mut packed: Reader<'_>, rows: usize, values: &mut Vec<f64>) -> Result<(), Broken> {
    let width = packed.byte()?;
    let mut bits = packed.word()?;
    let planes = Planes::decompress(packed.0, rows, width, false)?;
    planes.each(
        |difference| {
            bits = bits.wrapping_add(unzigzag(difference) as u64);
            f64::from_bits(bits)
        },
        values,
    );
    Ok(())
}
