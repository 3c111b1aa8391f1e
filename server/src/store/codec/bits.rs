//! A column as bit patterns, for values that are no multiples of a step.

use super::planes::{Planes, zigzag};
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

pub fn unpack(mut packed: Reader<'_>, values: &mut [f64]) -> Result<(), Broken> {
    let width = packed.byte()?;
    let mut bits = packed.word()?;
    Planes::decompress(packed.0, values.len(), width, false, |planes| {
        planes.each(values, |differences, values| {
            for (value, difference) in values.iter_mut().zip(differences) {
                bits = bits.wrapping_add(*difference as u64);
                *value = f64::from_bits(bits);
            }
        });
        Ok(())
    })
}
