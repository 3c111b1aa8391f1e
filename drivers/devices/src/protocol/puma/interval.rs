//! Set-point intervals: the time in which the joint reaches a new set-point.
//!
//! Jumpers E1 to E6 of the clock card select the interval at which the host of the document sends set-points (table
//! 2.6, which is not among the available pages); VAL-I uses 28 ms. The servo interpolates over `ninter` ticks. Its
//! initial values are `ninter` 32 and `eintscl` 3. The increment of a tick has 8 fractional bits, so it is the distance
//! shifted by `eintscl`: 2^3 / 2^8 = 1 / 32. Therefore `ninter` is a power of two.

use jointbench_instrument::roles::SetpointInterval;

/// One clock tick of the axis processor (s).
const TICK_S: f64 = 0.875e-3;
/// The interval of VAL-I in ticks: 28 ms.
pub const VAL_INTERVAL: u8 = 32;
/// The values of `ninter`.
const INTERVALS: [u8; 8] = [1, 2, 4, 8, 16, 32, 64, 128];

/// The set-point interval of `ninter`. `None`: the servo does not have it.
pub fn interval(ninter: u8) -> Option<SetpointInterval> {
    INTERVALS.contains(&ninter).then_some(SetpointInterval { tick_s: TICK_S, ticks: ninter })
}

/// All values of `ninter` with their intervals, in words.
pub fn intervals() -> String {
    INTERVALS.map(|ninter| format!("{ninter} ({} ms)", 1e3 * TICK_S * f64::from(ninter))).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_powers_of_two_of_the_tick() {
        assert_eq!(interval(VAL_INTERVAL).map(|val| val.duration_s()), Some(28e-3));
        assert_eq!(interval(33), None);
        let expected =
            "1 (0.875 ms), 2 (1.75 ms), 4 (3.5 ms), 8 (7 ms), 16 (14 ms), 32 (28 ms), 64 (56 ms), 128 (112 ms)";
        assert_eq!(intervals(), expected);
    }
}
