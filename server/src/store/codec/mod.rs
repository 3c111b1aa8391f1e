//! Compression of a column of samples: sensor counts if they reproduce every value bit by bit, otherwise the bit
//! patterns. Then first differences, byte planes and zstd level 1.
//!
//! ```text
//! byte 0     0 constant | 1 counts | 2 bits
//! constant   the value's bits, u64
//! counts     scale kind u8, corrected u8, width u8, factor f64, first i64, exceptions u32 × (row u32, bits u64), planes
//! bits       width u8, first u64, planes
//! planes     zstd of `width` planes of one byte for each row, lowest first; then one plane of corrections if corrected
//! ```
//! All values are little endian. A difference is stored as zigzag: 0, −1, 1, −2 … as 0, 1, 2, 3 …

mod bits;
mod counts;
mod planes;
mod scale;

pub use scale::Scale;

const CONSTANT: u8 = 0;
const COUNTS: u8 = 1;
const BITS: u8 = 2;

/// A packed column that cannot be unpacked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a block of samples cannot be unpacked")]
pub struct Broken;

/// Packs a column. `resolution` is the known step of the sensor; a wrong value costs space, but loses no data.
///
/// Takes about 10 ns for each value.
pub fn pack(values: &[f64], resolution: Option<f64>) -> Vec<u8> {
    if let Some((first, rest)) = values.split_first()
        && rest.iter().all(|value| value.to_bits() == first.to_bits())
    {
        return [&[CONSTANT][..], &first.to_bits().to_le_bytes()].concat();
    }
    scale::candidates(values, resolution)
        .into_iter()
        .find_map(|scale| counts::pack(values, scale))
        .unwrap_or_else(|| bits::pack(values))
}

/// Unpacks a column into `values`, which has its number of rows.
///
/// Takes about 2 ns for each value.
pub fn unpack(packed: &[u8], values: &mut [f64]) -> Result<(), Broken> {
    let mut rest = Reader(packed);
    match rest.byte()? {
        CONSTANT => {
            values.fill(f64::from_bits(rest.word()?));
            Ok(())
        }
        COUNTS => counts::unpack(rest, values),
        BITS => bits::unpack(rest, values),
        _ => Err(Broken),
    }
}

/// The remaining bytes of a packed column.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Broken> {
        let (head, rest) = self.0.split_first_chunk::<N>().ok_or(Broken)?;
        self.0 = rest;
        Ok(*head)
    }

    fn byte(&mut self) -> Result<u8, Broken> {
        Ok(u8::from_le_bytes(self.take()?))
    }

    fn half(&mut self) -> Result<u32, Broken> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    fn word(&mut self) -> Result<u64, Broken> {
        Ok(u64::from_le_bytes(self.take()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn check_lossless(values: &[f64], resolution: Option<f64>) -> usize {
        let packed = pack(values, resolution);
        let mut back = vec![7.0; values.len()];
        unpack(&packed, &mut back).unwrap();
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back), bits(values));
        packed.len()
    }

    fn any_value() -> impl Strategy<Value = f64> {
        prop_oneof![
            4 => any::<u64>().prop_map(f64::from_bits),
            4 => (-100_000i32..100_000).prop_map(|count| f64::from(count) * 0.001),
            1 => prop::sample::select(vec![0.0, -0.0, f64::MAX, f64::MIN, f64::MIN_POSITIVE, f64::NAN, f64::INFINITY]),
        ]
    }

    proptest! {
        #[test]
        fn any_column_comes_back(
            values in prop::collection::vec(any_value(), 0..300),
            resolution in prop::option::of(any::<f64>()),
        ) {
            check_lossless(&values, resolution);
        }

        #[test]
        fn counts_with_any_scale_come_back(
            counts in prop::collection::vec(-2_000_000i64..2_000_000, 1..300),
            step in 1e-12..1e6f64,
            declared in any::<bool>(),
            odd in prop::option::of((0usize..300, any_value())),
        ) {
            let mut values: Vec<f64> = counts.iter().map(|count| *count as f64 * step).collect();
            if let Some((row, value)) = odd && row < values.len() {
                values[row] = value;
            }
            check_lossless(&values, declared.then_some(step));
        }

        #[test]
        fn a_broken_block_is_an_error(bytes in prop::collection::vec(any::<u8>(), 0..60), rows in 0usize..40) {
            let mut values = vec![7.0; rows];
            let first = unpack(&bytes, &mut values);
            let mut again = vec![8.0; rows];
            prop_assert_eq!(unpack(&bytes, &mut again), first);
        }
    }

    /// A random walk of sensor counts: small differences, far from zero.
    fn walk(rows: usize) -> Vec<i64> {
        let step = |row: usize| (row as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(23) % 41;
        (0..rows)
            .scan(1_000_000i64, |at, row| {
                *at += step(row) as i64 - 20;
                Some(*at)
            })
            .collect()
    }

    /// Name, given resolution, and value of a count.
    type Case = (&'static str, Option<f64>, fn(i64) -> f64);

    #[test]
    fn sensor_counts_take_about_a_byte() {
        const ROWS: usize = 32_768;
        let turn = std::f64::consts::TAU;
        let cases: [Case; 5] = [
            ("counts times the resolution", Some(std::f64::consts::TAU / 16_384.0), |c| {
                c as f64 * (std::f64::consts::TAU / 16_384.0)
            }),
            ("counts times a turn, then divided", Some(turn / 16_384.0), |c| {
                c as f64 * std::f64::consts::TAU / 16_384.0
            }),
            ("decimals without a resolution", None, |c| c as f64 / 1e4),
            ("decimal fractions of a turn", Some(turn * 1e-6), |c| c as f64 / 1e6 * std::f64::consts::TAU),
            ("one in a thousand is not a count", Some(0.25), |c| if c % 1000 == 0 { -0.0 } else { c as f64 * 0.25 }),
        ];
        for (name, resolution, value) in cases {
            let values: Vec<f64> = walk(ROWS).into_iter().map(value).collect();
            let bytes = check_lossless(&values, resolution);
            assert!(bytes < ROWS * 5 / 4, "{name}: {bytes} bytes for {ROWS} rows");
        }
    }

    #[test]
    fn constants_and_regular_times_take_almost_nothing() {
        assert_eq!(check_lossless(&[-0.0; 1000], Some(0.1)), 9);
        let time_s: Vec<f64> = (0..10_000).map(|row| f64::from(row) * 0.004).collect();
        assert!(check_lossless(&time_s, None) < 2_500);
        let time_s: Vec<f64> = (0..10_000).map(|row| f64::from(row) / 250.0).collect();
        assert!(check_lossless(&time_s, None) < 100);
    }
}
