//! Checks whether a time rises, and classifies the violations.

use crate::note::{Note, plural};

/// Steps of a time that are not positive.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Order {
    /// Number of rows with the time of the row before.
    pub repeats: usize,
    /// Rows with an earlier time than the row before.
    pub back: Vec<usize>,
    /// Rows of `back` at which the time restarts.
    pub restarts: Vec<usize>,
    /// Step between two different stamps, if stamps repeat.
    pub tick_s: Option<f64>,
}

/// Smallest number of rows of a recording.
const RECORDING: usize = 10;
/// A time restarts if it falls into this first fraction of the recording before.
const AGAIN: f64 = 0.1;

impl Order {
    pub fn of(values: &[f64]) -> Order {
        let mut order = Order::default();
        let mut begin = 0;
        for row in 1..values.len() {
            let (before, now) = (values[row - 1], values[row]);
            if now == before {
                order.repeats += 1;
            } else if now < before {
                order.back.push(row);
                let first = values[begin];
                if now <= first + AGAIN * (before - first)
                    && row - begin >= RECORDING
                    && values.len() - row >= RECORDING
                {
                    order.restarts.push(row);
                    begin = row;
                }
            }
        }
        if order.repeats > 0 {
            let step = usual_step(values);
            order.tick_s = (step > 0.0).then_some(step);
        }
        order
    }
}

/// The median of the positive steps; 0 without any.
pub fn usual_step(values: &[f64]) -> f64 {
    let steps = values.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
    let mut steps: Vec<f64> = steps.take(10_000).collect();
    if steps.is_empty() {
        return 0.0;
    }
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Tolerance for rounding a rate, because a coarse clock does not determine it better.
const ROUND: f64 = 0.005;

/// Rows per second over all recordings, rounded if it is near a round number.
pub fn rate_hz(values: &[f64], starts: &[usize]) -> f64 {
    let mut ends: Vec<usize> = starts.to_vec();
    ends.push(values.len());
    let (mut begin, mut passed_s, mut steps) = (0, 0.0, 0);
    for end in ends {
        if end > begin {
            let forwards = values[begin..end].windows(2).map(|pair| (pair[1] - pair[0]).max(0.0));
            passed_s += forwards.sum::<f64>();
            steps += end - begin - 1;
        }
        begin = end;
    }
    let repeats = values.windows(2).any(|pair| pair[0] == pair[1]);
    // If every row has its own time, the usual step determines the rate in spite of gaps.
    let rate = if repeats { steps as f64 / passed_s } else { 1.0 / usual_step(values) };
    if !rate.is_finite() || rate <= 0.0 {
        return 1.0;
    }
    let digits = 10_f64.powf(rate.log10().floor() - 2.0);
    let round = (rate / digits).round() * digits;
    let rounder = (rate / (digits * 10.0)).round() * digits * 10.0;
    let nearly = |round: f64| (round / rate - 1.0).abs() < ROUND;
    let chosen = if nearly(rounder) { rounder } else { round };
    // Removes rounding errors of the powers of ten.
    format!("{chosen:.6}").parse().unwrap_or(chosen)
}

/// Spreads rows with the same stamp evenly up to the next stamp. The last rows keep the step before.
pub fn spread(values: &mut [f64]) {
    let mut from = 0;
    let mut step = 0.0;
    while from < values.len() {
        let count = values[from..].iter().take_while(|value| **value == values[from]).count();
        let start = values[from];
        let next = values.get(from + count).copied();
        step = match next {
            Some(next) if next > start => (next - start) / count as f64,
            _ => step,
        };
        for (place, value) in values[from..from + count].iter_mut().enumerate() {
            *value = start + place as f64 * step;
        }
        from += count;
    }
}

/// 0.0156 → `15.6 ms`.
pub fn seconds(value_s: f64) -> String {
    let (value, unit) = match value_s.abs() {
        large if large >= 1.0 => (value_s, "s"),
        middle if middle >= 1e-3 => (value_s * 1e3, "ms"),
        small if small >= 1e-6 => (value_s * 1e6, "µs"),
        _ => (value_s * 1e9, "ns"),
    };
    let digits = (2 - value.abs().max(1e-12).log10().floor() as i32).clamp(0, 3) as usize;
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} {unit}")
}

/// Length of a gap in usual steps.
const GAP: f64 = 10.0;
/// Deviation from the usual step above which a step is reported, as a fraction of the usual step.
const JITTER: f64 = 0.5;

/// Notes about gaps and uneven steps.
pub fn noticed(values: &[f64], starts: &[usize]) -> Vec<Note> {
    let usual = usual_step(values);
    let steps =
        || (1..values.len()).filter(|row| !starts.contains(row)).map(|row| (row, values[row] - values[row - 1]));
    let mut notes = Vec::new();
    if usual <= 0.0 || values.len() < RECORDING {
        return notes;
    }
    let gaps = steps().filter(|(_, step)| *step > GAP * usual).count();
    if let Some((row, longest)) = steps().max_by(|a, b| a.1.total_cmp(&b.1)).filter(|_| gaps > 0) {
        let message = format!(
            "the time has {}, the longest of {} after {:.3} s",
            plural(gaps, "gap"),
            seconds(longest),
            values[row - 1]
        );
        notes.push(Note::new(message));
    }
    let uneven = steps().filter(|(_, step)| (step / usual - 1.0).abs() > JITTER).count();
    if uneven - gaps > values.len() / 20 {
        let message = format!(
            "the time is uneven: {} differ clearly from the usual {}",
            plural(uneven - gaps, "step"),
            seconds(usual)
        );
        notes.push(Note::new(message));
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_that_does_not_rise_is_described() {
        let ticking: Vec<f64> = (0..100).map(|row| f64::from(row / 3) * 0.015625).collect();
        let order = Order::of(&ticking);
        assert_eq!((order.repeats, order.back.len(), order.tick_s), (66, 0, Some(0.015625)));
        let mut even = ticking.clone();
        spread(&mut even);
        assert!(even.windows(2).all(|pair| pair[1] > pair[0]) && (even[2] - 2.0 / 3.0 * 0.015625).abs() < 1e-12);

        let twice: Vec<f64> = (0..40).map(|row| f64::from(row % 20)).collect();
        assert_eq!(Order::of(&twice).restarts, [20]);
        let slip: Vec<f64> = (0..40).map(|row| if row == 30 { 28.5 } else { f64::from(row) }).collect();
        let order = Order::of(&slip);
        assert_eq!((order.back, order.restarts), (vec![30], Vec::new()));
    }

    #[test]
    fn rates_and_times_are_round() {
        let at = |hz: f64| rate_hz(&(0..1000).map(|row| f64::from(row) / hz).collect::<Vec<f64>>(), &[]);
        assert_eq!((at(200.0), at(1000.0), at(33.3), at(0.5)), (200.0, 1000.0, 33.3, 0.5));
        assert_eq!(rate_hz(&[0.0, 0.0], &[]), 1.0);
        assert_eq!(
            (seconds(0.015625), seconds(5e-3), seconds(2.5), seconds(2e-5)),
            ("15.6 ms".into(), "5 ms".into(), "2.5 s".into(), "20 µs".into())
        );
    }

    #[test]
    fn gaps_are_noticed() {
        let values: Vec<f64> = (0..100).map(|row| f64::from(row) * 0.01 + if row > 50 { 2.0 } else { 0.0 }).collect();
        let message = noticed(&values, &[])[0].to_string();
        assert_eq!(message, "the time has 1 gap, the longest of 2.01 s after 0.500 s");
        assert!(noticed(&values[..40], &[]).is_empty());
    }
}
