//! The count of an encoder, from its readings.

use crate::stats::summary::quantile;
use crate::thresholds::ON_MULTIPLES;
use std::f64::consts::TAU;

/// Counts in a turn, as powers of two.
const BITS: std::ops::RangeInclusive<u32> = 8..=24;
/// Numerical tolerance of the smallest difference, and the smallest difference that is none of rounding [rad].
const TOLERANCE: f64 = 1.01;
const LEAST: f64 = 1e-7;

/// The count of an encoder [rad], a power of two in a turn: the largest one whose multiples the readings are, and that
/// is no larger than their smallest difference. Zero if none is detected.
pub fn encoder_count(readings: &[f64]) -> f64 {
    let differences = readings.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > LEAST);
    let smallest = TOLERANCE * quantile(differences, 0.01);
    let mut counts = BITS.map(|bits| TAU / f64::from(1u32 << bits)).filter(|count| *count <= smallest);
    counts.find(|count| resultant(readings, *count) > ON_MULTIPLES).unwrap_or(0.0)
}

/// Mean resultant length of readings as angles within a count.
fn resultant(readings: &[f64], count: f64) -> f64 {
    let angle = |reading: &f64| (TAU * (reading - readings[0]) / count).sin_cos();
    let (sin, cos) = readings.iter().map(angle).fold((0.0, 0.0), |sum, (sin, cos)| (sum.0 + sin, sum.1 + cos));
    sin.hypot(cos) / readings.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::summary::mean;

    const COUNT: f64 = TAU / 16_384.0;

    fn turning(speed_rad: f64, count: f64) -> Vec<f64> {
        let angle = |i: i32| 0.3 + speed_rad * f64::from(i);
        (0..2000).map(|i| if count > 0.0 { (angle(i) / count).round() * count } else { angle(i) }).collect()
    }

    #[test]
    fn readings_show_the_count_of_their_encoder() {
        assert!((encoder_count(&turning(1.23e-3, COUNT)) - COUNT).abs() < 1e-12);
        assert!((encoder_count(&turning(1.23e-5, COUNT)) - COUNT).abs() < 1e-12);
        assert_eq!(encoder_count(&turning(1.23e-3, 0.0)), 0.0);
        assert_eq!(encoder_count(&[]), 0.0);
        assert_eq!(encoder_count(&[0.5; 20]), 0.0);
    }

    #[test]
    fn an_encoder_in_beat_with_its_samples_reads_half_a_count_wrong_for_long() {
        let speed = 3.001 * COUNT;
        let errors = turning(speed, COUNT).into_iter().zip(turning(speed, 0.0)).map(|(read, angle)| read - angle);
        let errors: Vec<f64> = errors.collect();
        let means = errors.chunks(50).map(mean);
        let largest = means.fold(0.0f64, |largest, mean| largest.max(mean.abs()));
        let bound = 0.5 * encoder_count(&turning(speed, COUNT));
        assert!((0.9 * bound..=bound).contains(&largest), "{largest} {bound}");
    }
}
