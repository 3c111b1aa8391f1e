//! The binary frame of the live stream.

use jointbench_instrument::Trace;

/// u32 sequence, u32 dropped frames, u32 rows, u32 channels, f64 t0.
pub const HEADER_BYTES: usize = 24;

/// Little endian: the header, then one f32 column after the other. `time_s` is relative to t0, the time of the first
/// row, because an f32 has too few digits for a long run. Unknown values are NaN.
pub fn encode(sequence: u32, dropped: u32, rows: &Trace) -> Vec<u8> {
    let (count, width) = (rows.len(), rows.channels().len());
    let t0_s = rows.column("time_s").and_then(|time| time.first().copied()).unwrap_or(0.0);
    let mut frame = Vec::with_capacity(HEADER_BYTES + 4 * count * width);
    for number in [sequence, dropped, count as u32, width as u32] {
        frame.extend_from_slice(&number.to_le_bytes());
    }
    frame.extend_from_slice(&t0_s.to_le_bytes());
    for (channel, column) in rows.channels().iter().zip(rows.columns()) {
        let zero = if channel.name == "time_s" { t0_s } else { 0.0 };
        for value in column {
            frame.extend_from_slice(&((value - zero) as f32).to_le_bytes());
        }
    }
    frame
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_instrument::Channel;

    #[test]
    fn a_frame_is_a_header_and_columns() {
        let channels = vec![Channel::new("time_s"), Channel::new("motor_current_a")];
        let rows = Trace::from_columns(channels, vec![vec![3600.0, 3600.004], vec![0.5, -0.25]]);
        let frame = encode(7, 1, &rows);
        assert_eq!(frame.len(), HEADER_BYTES + 4 * 2 * 2);
        let word = |at: usize| u32::from_le_bytes(frame[at..at + 4].try_into().unwrap());
        assert_eq!([word(0), word(4), word(8), word(12)], [7, 1, 2, 2]);
        assert_eq!(f64::from_le_bytes(frame[16..24].try_into().unwrap()), 3600.0);
        let value = |i: usize| f32::from_bits(word(HEADER_BYTES + 4 * i));
        assert_eq!(value(0), 0.0);
        assert!((value(1) - 0.004).abs() < 1e-6, "{}", value(1));
        assert_eq!((value(2), value(3)), (0.5, -0.25));
    }
}
