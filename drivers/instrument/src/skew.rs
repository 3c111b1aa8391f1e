//! Aligns readings of different instruments in time.
//!
//! The joint determines the time of a run's rows: `time_s` is the time of its reading. Another instrument is read at
//! another moment of the same tick. The row keeps its value as measured, together with the difference in time, the
//! skew. Before any computation on a run, such columns are interpolated linearly to the times of the rows.

use crate::{Channel, Trace};

/// Delay of one instrument's reading relative to another's, and the largest error of that delay in either direction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Skew {
    /// Delay; negative if the reading came earlier.
    pub s: f64,
    /// Largest error of the delay, in either direction.
    pub uncertainty_s: f64,
}

/// Time of the torque reading relative to the row.
pub const TORQUE_SKEW: &str = "torque_skew_s";
/// Time of the brake current reading relative to the row. The supply is read less often than the joint, and its reading
/// held.
pub const BRAKE_SKEW: &str = "brake_current_skew_s";
/// Time of the thermometer reading relative to the row. The thermometer is read least often.
pub const THERMOMETER_SKEW: &str = "thermometer_skew_s";
/// Times are stored in whole microseconds; times that differ by less than this are equal.
const HELD_S: f64 = 3e-6;

/// The skew columns and the columns that each applies to. A thermometer's first channel may be the joint's temperature.
pub fn skewed(trace: &Trace) -> [(&'static str, Vec<String>); 3] {
    let replaces_joint = trace.column("thermometer_1_c").is_none();
    let is_thermometer = |name: &str| name.starts_with("thermometer_") && name.ends_with("_c");
    let thermometers = trace.channels().iter().map(|channel| &channel.name);
    let thermometers =
        thermometers.filter(|name| is_thermometer(name) || replaces_joint && *name == "temperature_c").cloned();
    let torque = ["link_torque_nm", "brake_torque_nm", "other_range_torque_nm"].map(str::to_owned);
    [
        (TORQUE_SKEW, torque.into()),
        (BRAKE_SKEW, vec!["brake_current_a".into()]),
        (THERMOMETER_SKEW, thermometers.collect()),
    ]
}

/// The value at each time of the grid, by linear interpolation. `None` if a reading is missing on one side: no
/// extrapolation.
///
/// Both time columns must rise. Cost: one pass over both.
fn on_grid(at_s: &[f64], values: &[f64], grid_s: &[f64]) -> Vec<Option<f64>> {
    let mut behind = 0;
    let at = |moment_s: &f64| {
        while behind < at_s.len() && at_s[behind] < *moment_s {
            behind += 1;
        }
        if at_s.get(behind) == Some(moment_s) {
            return Some(values[behind]);
        }
        let before = behind.checked_sub(1)?;
        let share = (moment_s - at_s[before]) / (at_s.get(behind)? - at_s[before]);
        Some(values[before] + share * (values[behind] - values[before]))
    };
    grid_s.iter().map(at).collect()
}

/// Moves every column with a skew to the times of its rows and sets the skew to 0. Interpolates only within a segment,
/// because the time between two segments is not recorded. A value with no reading on one side stays as measured.
pub(crate) fn align(trace: Trace) -> Trace {
    skewed(&trace).into_iter().fold(trace, |trace, (skew, columns)| align_by(trace, skew, &columns))
}

fn align_by(trace: Trace, skew: &str, skewed: &[String]) -> Trace {
    let Some(skew_s) = trace.column(skew).filter(|skew| skew.iter().any(|s| *s != 0.0)) else { return trace };
    let time_s = trace.column("time_s").unwrap_or_default();
    let reading_s: Vec<f64> = time_s.iter().zip(skew_s).map(|(at_s, skew_s)| at_s + skew_s).collect();
    let ends: Vec<usize> = match trace.column("segment") {
        Some(segment) => (1..=time_s.len()).filter(|at| segment.get(*at) != Some(&segment[at - 1])).collect(),
        None => vec![time_s.len()],
    };
    // A held reading is in several rows. It counts once, at its own time.
    let is_fresh = |i: usize, start: usize| i == start || reading_s[i] > reading_s[i - 1] + HELD_S;
    let time_s = time_s.to_vec();
    let (mut channels, mut columns) = trace.into_parts();
    for (channel, column) in channels.iter_mut().zip(&mut columns) {
        if channel.name == skew {
            column.fill(0.0);
        }
        if !skewed.contains(&channel.name) {
            continue;
        }
        let mut start = 0;
        for end in &ends {
            let fresh: Vec<usize> = (start..*end).filter(|i| is_fresh(*i, start)).collect();
            let of = |values: &[f64]| -> Vec<f64> { fresh.iter().map(|i| values[*i]).collect() };
            let grid = on_grid(&of(&reading_s), &of(column), &time_s[start..*end]);
            let rows = column[start..*end].iter_mut().zip(grid);
            rows.for_each(|(reading, value)| *reading = value.unwrap_or(*reading));
            start = *end;
        }
        // An interpolated value is no longer a whole count.
        *channel = Channel::new(&channel.name);
    }
    Trace::from_columns(channels, columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_readings_is_a_straight_line_and_beyond_them_nothing() {
        let grid = on_grid(&[0.0, 1.0, 2.0], &[0.0, 10.0, 0.0], &[-0.1, 0.0, 0.25, 1.5, 2.0, 2.1]);
        assert_eq!(grid, [None, Some(0.0), Some(2.5), Some(5.0), Some(0.0), None]);
        assert_eq!(on_grid(&[], &[], &[1.0]), [None]);
    }

    #[test]
    fn a_delayed_column_is_moved_to_its_rows_within_its_segment() {
        let channels = ["time_s", "link_torque_nm", "torque_skew_s", "motor_current_a", "segment"].map(Channel::new);
        let rows: Vec<[f64; 5]> = (0..8)
            .map(|i| {
                let (at_s, segment) = (f64::from(i) * 0.01, f64::from(i / 4));
                // Rises by 100 Nm/s and starts again with each segment.
                [at_s, 100.0 * (at_s + 2e-3) + 50.0 * segment, 2e-3, 1.0, segment]
            })
            .collect();
        let mut trace = Trace::new(channels.into());
        rows.iter().for_each(|row| trace.push_row(row));
        let aligned = align(trace.clone());
        let torque_nm = aligned.column("link_torque_nm").unwrap();
        for (i, row) in rows.iter().enumerate() {
            // The first sample of a segment has no earlier reading: it does not change.
            let expected = if i % 4 == 0 { row[1] } else { row[1] - 0.2 };
            assert!((torque_nm[i] - expected).abs() < 1e-9, "row {i}: {}", torque_nm[i]);
        }
        assert_eq!(aligned.column("motor_current_a"), trace.column("motor_current_a"));
        assert_eq!(align(aligned.clone()), aligned, "once is enough");
    }

    #[test]
    fn a_reading_that_is_held_counts_at_its_own_moment() {
        // A current that rises by 1 A/s, read every fifth row and 1 ms before it.
        let channels = ["time_s", "brake_current_a", "brake_current_skew_s", "segment"].map(Channel::new);
        let mut trace = Trace::new(channels.into());
        for i in 0..23 {
            let (at_s, read_s) = (f64::from(i) * 0.02, f64::from(i / 5 * 5) * 0.02 - 1e-3);
            trace.push_row(&[at_s, read_s, read_s - at_s, 0.0]);
        }
        let aligned = align(trace.clone());
        let (current_a, time_s) = (aligned.column("brake_current_a").unwrap(), trace.column("time_s").unwrap());
        for i in 0..20 {
            assert!((current_a[i] - time_s[i]).abs() < 1e-9, "row {i}: {}", current_a[i]);
        }
        assert!((current_a[22] - 0.399).abs() < 1e-9, "nothing is invented behind the last: {}", current_a[22]);
    }
}
