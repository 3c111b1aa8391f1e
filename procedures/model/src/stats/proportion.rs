//! Interval of a proportion.

/// Quantile of the standard normal distribution for two-sided 95 %.
pub const Z95: f64 = 1.959_963_984_540_054;

/// 95 % interval of `count / of` (Wilson 1927): valid for small numbers and for proportions of 0 and 1. It is 0 to 1 if
/// `of` is 0.
pub fn wilson_interval(count: u64, of: u64) -> [f64; 2] {
    if of == 0 {
        return [0.0, 1.0];
    }
    let (n, proportion) = (of as f64, count as f64 / of as f64);
    let z2_n = Z95 * Z95 / n;
    let centre = proportion + z2_n / 2.0;
    let half = Z95 * (proportion * (1.0 - proportion) / n + z2_n / (4.0 * n)).sqrt();
    [-1.0, 1.0].map(|side| ((centre + side * half) / (1.0 + z2_n)).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_agrees_with_published_values() {
        // Newcombe 1998, table I: 81 of 263, 15 of 148, 0 of 20, 1 of 29.
        for (count, of, expected) in [
            (81, 263, [0.2553, 0.3662]),
            (15, 148, [0.0624, 0.1605]),
            (0, 20, [0.0, 0.1611]),
            (1, 29, [0.0061, 0.1718]),
        ] {
            let found = wilson_interval(count, of);
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 5e-5, "{count} of {of}: {found} {expected}");
            }
        }
        assert_eq!(wilson_interval(3, 3)[1], 1.0);
        assert_eq!(wilson_interval(0, 0), [0.0, 1.0]);
    }
}
