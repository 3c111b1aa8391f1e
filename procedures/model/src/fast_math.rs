//! e^x and ln x without branches, so that a loop over a column is vectorized.
//!
//! Within 2⁻⁵⁰ of the true value (relative for e^x, absolute for ln x where that is larger), and identical on every
//! machine.

use std::f64::consts::{FRAC_1_SQRT_2, LOG2_E, SQRT_2};

/// ln 2 in two parts: the first times an integer below 2¹¹ is exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
/// Adding and subtracting this number rounds a number below 2⁵¹ to an integer, which is then in the lowest bits.
const WHOLE: f64 = 6_755_399_441_055_744.0;
/// 2⁵²: adding an integer puts it in the lower bits.
const ONES: f64 = 4_503_599_627_370_496.0;
/// Exponent of 1.0 in its bit representation.
const BIAS: u64 = 1023;

/// e^x, limited to about the smallest and the largest normal number.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    let x = if x > -708.0 { x } else { -708.0 };
    let x = if x < 709.0 { x } else { 709.0 };
    let shifted = x * LOG2_E + WHOLE;
    let whole = shifted - WHOLE;
    let r = (x - whole * LN_2[0]) - whole * LN_2[1];
    // Taylor series up to r¹³/13!: for |r| ≤ ln 2 / 2 the remainder is below 1e-17.
    let mut sum = 1.0 / 6_227_020_800.0;
    for n in [
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ] {
        sum = sum * r + n;
    }
    sum * f64::from_bits(shifted.to_bits().wrapping_add(BIAS) << 52)
}

/// ln x of a normal number x > 0.
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    let bits = x.to_bits();
    let exponent = f64::from_bits(bits >> 52 | ONES.to_bits()) - ONES - BIAS as f64;
    let mantissa = f64::from_bits(bits & ((1 << 52) - 1) | BIAS << 52);
    let is_high = mantissa > SQRT_2;
    let m = if is_high { 0.5 * mantissa } else { mantissa };
    let exponent = if is_high { exponent + 1.0 } else { exponent };
    debug_assert!((FRAC_1_SQRT_2..=SQRT_2).contains(&m));
    // 2·artanh s, |s| ≤ 0.172: the series up to s²¹/21.
    let s = (m - 1.0) / (m + 1.0);
    let square = s * s;
    let mut sum = 1.0 / 21.0;
    for odd in [19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0] {
        sum = sum * square + 1.0 / odd;
    }
    2.0 * s * sum + exponent * LN_2[1] + exponent * LN_2[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_what_the_standard_library_says() {
        for i in 0..2_000_000 {
            let x = 700.0 - f64::from(i) * 7e-4;
            let (found, truth) = (exp(x), x.exp());
            assert!((found - truth).abs() <= 1e-15 * truth, "e^{x}: {found} {truth}");
            let x = 1e-12 * (f64::from(i) * 3e-5).exp();
            let (found, truth) = (ln(x), x.ln());
            assert!((found - truth).abs() <= 1e-15 * truth.abs().max(1.0), "ln {x}: {found} {truth}");
        }
        assert_eq!((exp(0.0), ln(1.0)), (1.0, 0.0));
        assert!(exp(-1e6) < 1e-300 && exp(f64::NEG_INFINITY) < 1e-300);
    }
}
