//! Sensor faults: a constant value during motion, saturation, and single outliers.

use crate::stats::summary::range;
use crate::thresholds::{
    FINE_READINGS, PULSE_SAMPLES, PULSE_SPEED, SATURATED_SAMPLES, SATURATED_SHARE, SPIKE_CHANGES, SPIKE_COUNTS,
    SPIKE_NEIGHBOURS, SPIKE_RANGE, STUCK_S, STUCK_SAMPLES,
};
use crate::words::figure;
use jointbench_instrument::units::unit_of;
use jointbench_instrument::{Kind, RunTable};
use std::ops::Range;

/// Columns of measured torque and current, which always contain noise, and the angle that shows whether the joint
/// moves.
fn columns(kind: Kind) -> (&'static [&'static str], &'static str) {
    match kind {
        Kind::Friction => (&["motor_current_a", "link_torque_nm"], "motor_position_rad"),
        Kind::Stiffness => (&["link_torque_nm"], "motor_position_rad"),
        Kind::Brake => (&["brake_torque_nm"], "position_rad"),
        Kind::Encoder => (&[], "reference_position_rad"),
    }
}

/// Columns with a stuck or saturated sensor, each in a sentence.
pub fn failed(run: &RunTable) -> Vec<String> {
    let fault = |column: Column| clipped(run, &column).or_else(|| stuck_text(run, &column, &column.stuck(run)));
    fine_columns(run).filter_map(fault).collect()
}

/// Rows without a reading of the torque, in order, and a sentence for each column with such rows: its sensor is stuck.
pub fn unread(run: &RunTable) -> (Vec<Range<usize>>, Vec<String>) {
    let (mut rows, mut texts) = (Vec::new(), Vec::new());
    for column in fine_columns(run) {
        let stuck = column.stuck(run);
        texts.extend(stuck_text(run, &column, &stuck));
        rows.extend(stuck);
    }
    rows.sort_by_key(|range: &Range<usize>| range.start);
    rows.dedup_by(|next, range| {
        let overlap = next.start <= range.end;
        range.end = if overlap { range.end.max(next.end) } else { range.end };
        overlap
    });
    (rows, texts)
}

/// A column of fine readings, with its long ranges of equal values.
struct Column<'r> {
    name: &'static str,
    values: &'r [f64],
    same: Vec<Range<usize>>,
}

/// The columns of torque and current whose readings are fine enough for these checks.
fn fine_columns(run: &RunTable) -> impl Iterator<Item = Column<'_>> {
    columns(run.kind()).0.iter().filter_map(|name| {
        let values = run.column(name)?;
        let same = stretches_of_one_value(values);
        let resting: usize = same.iter().map(|range| range.len() - 1).sum();
        let long: Vec<Range<usize>> =
            same.iter().filter(|range| range.len() >= SATURATED_SAMPLES as usize).cloned().collect();
        let long_resting: usize = long.iter().map(|range| range.len() - 1).sum();
        let rest = (values.len() - 1 - long_resting).max(1) as f64;
        // One long stretch is a fault; a coarse column has many.
        let longest = long.iter().map(|range| range.len() - 1).max().unwrap_or(0);
        let is_fine = (resting - long_resting) as f64 <= (1.0 - FINE_READINGS) * rest
            && 2 * (long_resting - longest) < values.len() - 1 - longest;
        is_fine.then_some(Column { name, values, same: long })
    })
}

/// Ranges of equal neighbouring values.
fn stretches_of_one_value(values: &[f64]) -> Vec<Range<usize>> {
    let mut start = 0;
    let ends = values.chunk_by(|a, b| a == b).map(|part| {
        start += part.len();
        start - part.len()..start
    });
    ends.filter(|range| range.len() > 1).collect()
}

fn clipped(run: &RunTable, Column { name, values, same }: &Column) -> Option<String> {
    let (low, high) = range(values);
    let at = |end: f64| same.iter().filter(|range| values[range.start] == end).map(|range| range.len()).sum::<usize>();
    let (end, count) = [(high, at(high)), (low, at(low))].into_iter().max_by_key(|(_, count)| *count)?;
    (count as f64 >= SATURATED_SHARE * values.len() as f64).then(|| {
        let unit = run.meta().motion.label(unit_of(name).unwrap_or_default());
        format!(
            "{name} is saturated at {} for {count} samples: the range of its sensor, or a limit of the drive",
            figure(end, &unit)
        )
    })
}

impl Column<'_> {
    /// The ranges of one value while the joint moves.
    fn stuck(&self, run: &RunTable) -> Vec<Range<usize>> {
        let Some((time_s, angle)) = run.column("time_s").zip(run.column(columns(run.kind()).1)) else {
            return Vec::new();
        };
        let is_stuck = |range: &&Range<usize>| {
            let moves = angle[(*range).clone()].windows(2).filter(|pair| pair[0] != pair[1]).count();
            let lasts_s = time_s[range.end - 1] - time_s[range.start];
            2 * moves > range.len() && range.len() >= STUCK_SAMPLES as usize && lasts_s >= STUCK_S
        };
        self.same.iter().filter(is_stuck).cloned().collect()
    }
}

fn stuck_text(run: &RunTable, Column { name, values, .. }: &Column, stuck: &[Range<usize>]) -> Option<String> {
    let time_s = run.column("time_s")?;
    let longest = stuck.iter().max_by_key(|range| range.len())?;
    let others = match stuck.len() - 1 {
        0 => String::new(),
        1 => ", and in another stretch".into(),
        count => format!(", and in {count} other stretches"),
    };
    let unit = run.meta().motion.label(unit_of(name).unwrap_or_default());
    Some(format!(
        "{name} stays at {} from {:.3} s to {:.3} s{others}, while the joint moves: the drive was off, or the sensor was not read",
        figure(values[longest.start], &unit),
        time_s[longest.start],
        time_s[longest.end - 1]
    ))
}

/// Single outliers, in a sentence.
pub fn spikes(run: &RunTable) -> Option<String> {
    let (torques, angle) = columns(run.kind());
    let (time_s, angle) = (run.column("time_s")?, run.column(angle)?);
    let way = |i: usize, j: usize| angle[j.min(angle.len() - 1)] - angle[i];
    let steps = PULSE_SAMPLES as usize;
    // Whether the drive accelerates at this sample.
    let is_pushed = |i: usize, fastest: f64| {
        let before = way((i - 1).saturating_sub(steps), i - 1);
        (way(i + 1, i + 1 + steps) - before).abs() > PULSE_SPEED * fastest
    };
    torques.iter().chain(&["motor_velocity_rad_s", "velocity_rad_s", "temperature_c"]).find_map(|name| {
        let values = run.column(name)?;
        let every = values.len().div_ceil(crate::preprocess::INFORMATIVE_ROWS);
        let usual = crate::preprocess::median(values.windows(2).step_by(every).map(|pair| (pair[1] - pair[0]).abs()));
        let (low, high) = middle_of(values.iter().step_by(every).copied().collect());
        let least = (SPIKE_CHANGES * usual).max(SPIKE_RANGE * (high - low)).max(SPIKE_COUNTS * count(values).unwrap_or(0.0));
        let is_alone = |w: &[f64]| {
            let (before, after) = (w[1] - w[0], w[1] - w[2]);
            let off = before.abs().min(after.abs());
            off > least && before * after > 0.0 && (w[2] - w[0]).abs() < SPIKE_NEIGHBOURS * off
        };
        let mut found: Vec<usize> = (1..).zip(values.windows(3)).filter(|(_, w)| is_alone(w)).map(|(i, _)| i).collect();
        // An oscillation from sample to sample has no single sample.
        let all = found.clone();
        found.retain(|i| all.binary_search(&(i + 1)).is_err() && all.binary_search(&(i - 1)).is_err());
        if !found.is_empty() {
            let fastest = (steps..angle.len()).map(|i| way(i - steps, i).abs()).fold(0.0, f64::max);
            found.retain(|i| !is_pushed(*i, fastest));
        }
        let first = *found.first()?;
        let unit = run.meta().motion.label(unit_of(name).unwrap_or_default());
        let (samples, them) = match found.len() {
            1 => ("one sample that stands alone,".to_owned(), "it"),
            count => (format!("{count} samples that stand alone, the first"), "them"),
        };
        Some(format!(
            "{name} has {samples} at {:.3} s with {}: the fit bends towards {them}; check the cable, or leave {them} out",
            time_s[first],
            figure(values[first], &unit)
        ))
    })
}

/// Smallest change between readings that stay, as coarse readings do. `None` for readings that never stay.
fn count(values: &[f64]) -> Option<f64> {
    let stays = values.windows(4).filter(|w| w[0] == w[1] && w[1] != w[2] && w[2] == w[3]);
    stays.map(|w| (w[2] - w[1]).abs()).min_by(f64::total_cmp)
}

/// The range of all values but 1 % at each end.
fn middle_of(mut values: Vec<f64>) -> (f64, f64) {
    let (low, high) = (values.len() / 100, values.len() - 1 - values.len() / 100);
    let low = *values.select_nth_unstable_by(low, f64::total_cmp).1;
    let high = *values.select_nth_unstable_by(high, f64::total_cmp).1;
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_instrument::{Channel, Meta, Trace};

    /// A joint that swings, whose current passes through `reading`.
    fn run(reading: impl Fn(usize, f64) -> f64) -> RunTable {
        let names = ["time_s", "motor_position_rad", "motor_current_a"];
        let mut trace = Trace::new(names.map(Channel::new).to_vec());
        for i in 0..4000 {
            let t = 0.004 * i as f64;
            let noise = 0.02 * (12.9898 * i as f64).sin();
            let current = 0.4 * (0.5 * t).cos().signum() + 1.2 * (0.5 * t).cos() + noise;
            trace.push_row(&[t, 30.0 * (0.5 * t).sin(), reading(i, current)]);
        }
        RunTable::new(Meta { kind: Some(Kind::Friction), ..Meta::default() }, trace).unwrap()
    }

    #[test]
    fn a_stuck_saturated_or_spiking_sensor_is_reported() {
        let whole = run(|_, current| current);
        assert_eq!((failed(&whole), spikes(&whole)), (Vec::new(), None));
        let clipped = failed(&run(|_, current| current.clamp(-1.4, 1.4)));
        assert!(
            matches!(&clipped[..], [one] if one.starts_with("motor_current_a is saturated at 1.40 A")),
            "{clipped:?}"
        );
        let stuck = failed(&run(|i, current| if (1000..1100).contains(&i) { 0.7 } else { current }));
        assert!(matches!(&stuck[..], [one] if one.contains("from 4.000 s to 4.396 s")), "{stuck:?}");
        assert_eq!(unread(&whole), (Vec::new(), Vec::new()));
        let (rows, texts) = unread(&run(|i, current| if i % 1000 < 100 { 0.0 } else { current }));
        assert_eq!(rows, [0..100, 1000..1100, 2000..2100, 3000..3100]);
        assert!(texts[0].starts_with("motor_current_a stays at 0.00 A from"), "{texts:?}");
        assert!(texts[0].contains(", and in 3 other stretches, while the joint moves: the drive was off"), "{texts:?}");
        let spiked = spikes(&run(|i, current| if i % 997 == 500 { 6.0 } else { current })).unwrap_or_default();
        assert!(spiked.starts_with("motor_current_a has 4 samples that stand alone, the first at 2.000 s"), "{spiked}");
    }

    #[test]
    fn a_pulse_that_begins_a_step_is_no_spike() {
        let names = ["time_s", "motor_position_rad", "motor_current_a", "temperature_c"];
        let reported = |pulse: f64, warmest: f64| {
            let mut trace = Trace::new(names.map(Channel::new).to_vec());
            let mut position = 0.0;
            for i in 0..4000u32 {
                let (step, at) = (i / 400, i % 400);
                let speed = f64::from(1 + step);
                position += 0.004 * speed;
                let noise = 0.01 * (12.9898 * f64::from(i)).sin();
                let current = 0.2 + 0.02 * speed + noise + if at == 0 { pulse } else { 0.0 };
                trace.push_row(&[0.004 * f64::from(i), position, current, if i == 1234 { warmest } else { 25.0 }]);
            }
            spikes(&RunTable::new(Meta { kind: Some(Kind::Friction), ..Meta::default() }, trace).unwrap())
        };
        assert_eq!(reported(3.0, 25.0), None);
        assert!(reported(3.0, 1e30).is_some_and(|reported| reported.starts_with("temperature_c has one sample")));
    }

    #[test]
    fn a_reading_that_flickers_by_one_count_has_no_outlier() {
        let names = ["time_s", "motor_position_rad", "motor_current_a", "temperature_c"];
        let warming = |warmest: f64| {
            let mut trace = Trace::new(names.map(Channel::new).to_vec());
            for i in 0..4000 {
                let t = 0.004 * f64::from(i);
                let count = f64::from(i / 2000) + f64::from(u8::from(i % 150 == 20));
                let warm = if i == 1234 { warmest } else { 25.0 + 0.05 * count };
                trace.push_row(&[t, 30.0 * (0.5 * t).sin(), 0.4 * (0.5 * t).cos(), warm]);
            }
            spikes(&RunTable::new(Meta { kind: Some(Kind::Friction), ..Meta::default() }, trace).unwrap())
        };
        assert_eq!(warming(25.0), None);
        assert!(warming(27.0).is_some_and(|reported| reported.starts_with("temperature_c has one sample")));
    }

    #[test]
    fn a_coarse_current_sticks_nowhere() {
        let coarse = run(|_, current| (current / 0.25).round() * 0.25);
        assert_eq!((failed(&coarse), spikes(&coarse)), (Vec::new(), None));
    }
}
