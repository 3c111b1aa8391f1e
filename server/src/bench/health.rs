//! Input quality of the channels of a run: rate, time of the last sample, and number of missing samples.

use crate::view::ChannelHealth;
use jiff::{SignedDuration, Timestamp};
use jointbench_instrument::skew::skewed;
use jointbench_instrument::units::unit_of;
use jointbench_instrument::{Bench, Trace};
use jointbench_procedure::engine::SLOW_EVERY_S;
use serde::{Deserialize, Serialize};

/// Minimum time for the calculation of a rate.
const OVER_S: f64 = 1.0;
/// Times are stored in microseconds: times with a smaller difference are equal.
const SAME_S: f64 = 3e-6;

/// Input quality of a channel, as far as it is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChannelInput {
    name: String,
    rate_hz: Option<f64>,
    sampled: Option<Timestamp>,
    dropped: u64,
}

impl ChannelInput {
    pub fn view(&self, now: Timestamp) -> ChannelHealth {
        ChannelHealth {
            name: self.name.clone(),
            unit: unit_of(&self.name).map(str::to_owned),
            rate_hz: self.rate_hz,
            at: self.sampled.map(|sampled| format!("{sampled:.3}")),
            age_s: self.sampled.map(|sampled| now.duration_since(sampled).as_secs_f64().max(0.0)),
            dropped: self.dropped,
        }
    }
}

/// The channels of every run on this bench. The channels of a run replace them.
pub(super) fn expected(bench: &Bench) -> Vec<ChannelInput> {
    let joint = bench.joint.resolution();
    let channels = [
        ("motor_position_rad", true),
        ("motor_velocity_rad_s", true),
        ("motor_current_a", true),
        ("link_position_rad", joint.link_position.is_some()),
        ("link_torque_nm", bench.torque_sensor.is_some()),
        ("temperature_c", joint.temperature.is_some() || bench.thermometer.is_some()),
        ("brake_current_a", bench.brake.is_some()),
        ("reference_position_rad", bench.reference_encoder.is_some()),
        ("test_position_rad", bench.test_encoder.is_some()),
    ];
    let there = channels.into_iter().filter(|(_, there)| *there);
    there.map(|(name, _)| ChannelInput { name: name.to_owned(), rate_hz: None, sampled: None, dropped: 0 }).collect()
}

pub(super) struct Health {
    period_s: f64,
    /// Time and segment of the newest row.
    newest: Option<(f64, f64)>,
    /// Rows that are missing within segments.
    missing: u64,
    channels: Vec<Known>,
}

/// State of a channel that has a unit.
struct Known {
    at: usize,
    name: String,
    /// Column of the time offset of the measurement, if it differs from the time of the row.
    skew: Option<usize>,
    /// A reading within this time after the last one is a held value.
    apart_s: f64,
    /// Readings for the rate: first and last time, and number of readings after the first.
    over: Option<(f64, f64, u32)>,
    rate_hz: Option<f64>,
    /// Rows without a value after the first value.
    empty: u64,
}

impl Health {
    pub fn new(rate_hz: f64) -> Self {
        Self { period_s: 1.0 / rate_hz, newest: None, missing: 0, channels: Vec::new() }
    }

    pub fn add(&mut self, rows: &Trace) {
        let Some(time_s) = rows.column("time_s") else { return };
        if self.channels.is_empty() {
            self.channels = known(rows);
        }
        let segment = rows.column("segment");
        for (row, &now_s) in time_s.iter().enumerate() {
            let segment = segment.map_or(0.0, |segment| segment[row]);
            if let Some((before_s, before)) = self.newest.replace((now_s, segment))
                && before == segment
            {
                self.missing += ((now_s - before_s) / self.period_s - 0.5).max(0.0) as u64;
            }
            for channel in &mut self.channels {
                channel.add(rows, row, now_s);
            }
        }
    }

    /// `now`: arrival time of the newest row.
    pub fn channels(&self, now: Timestamp) -> Vec<ChannelInput> {
        let newest_s = self.newest.map_or(0.0, |(at_s, _)| at_s);
        let incoming = |channel: &Known| {
            let age = channel.over.map(|(_, last_s, _)| SignedDuration::from_secs_f64((newest_s - last_s).max(0.0)));
            ChannelInput {
                name: channel.name.clone(),
                rate_hz: channel.rate_hz,
                sampled: age.map(|age| now - age),
                dropped: self.missing + channel.empty,
            }
        };
        self.channels.iter().map(incoming).collect()
    }
}

impl Known {
    fn add(&mut self, rows: &Trace, row: usize, now_s: f64) {
        if !rows.columns()[self.at][row].is_finite() {
            self.empty += u64::from(self.over.is_some());
            return;
        }
        let felt_s = now_s + self.skew.map_or(0.0, |skew| rows.columns()[skew][row]);
        let (first_s, last_s, count) = self.over.get_or_insert((felt_s, felt_s, 0));
        if felt_s < *last_s + self.apart_s {
            return;
        }
        (*last_s, *count) = (felt_s, *count + 1);
        if felt_s - *first_s >= OVER_S || self.rate_hz.is_none() {
            self.rate_hz = Some(f64::from(*count) / (felt_s - *first_s));
        }
        if felt_s - *first_s >= OVER_S {
            self.over = Some((felt_s, felt_s, 0));
        }
    }
}

fn known(rows: &Trace) -> Vec<Known> {
    let skewed = skewed(rows);
    let channels = rows.channels().iter().enumerate();
    let measured = channels.filter(|(_, channel)| channel.unit().is_some() && !is_time(&channel.name));
    let known = measured.map(|(at, channel)| {
        let name = channel.name.clone();
        let skew = skewed.iter().find(|(_, names)| names.contains(&name)).and_then(|(skew, _)| rows.index_of(skew));
        let slow = skew.is_none() && ["temperature_c", "brake_current_a"].contains(&name.as_str());
        let apart_s = if slow { SLOW_EVERY_S } else { SAME_S };
        Known { at, name, skew, apart_s, over: None, rate_hz: None, empty: 0 }
    });
    known.collect()
}

fn is_time(name: &str) -> bool {
    name == "time_s" || name.ends_with("_skew_s")
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_instrument::Channel;
    use jointbench_instrument::skew::BRAKE_SKEW;

    fn rows(times: impl Iterator<Item = f64>) -> Trace {
        let names = ["time_s", "link_torque_nm", "temperature_c", "brake_current_a", BRAKE_SKEW, "segment"];
        let mut rows = Trace::new(names.map(Channel::new).into());
        for at_s in times {
            // The supply was read every 0.1 s.
            let read_s = (at_s * 10.0 + 1e-6).floor() / 10.0;
            rows.push_row(&[at_s, at_s.sin(), 25.0, 0.5, read_s - at_s, f64::from(u8::from(at_s > 3.0))]);
        }
        rows
    }

    fn rates(health: &Health) -> Vec<(String, f64, u64)> {
        let rounded = |one: ChannelInput| (one.name, (10.0 * one.rate_hz.unwrap_or(0.0)).round() / 10.0, one.dropped);
        health.channels(Timestamp::UNIX_EPOCH).into_iter().map(rounded).collect()
    }

    #[test]
    fn a_held_reading_counts_once() {
        let mut health = Health::new(250.0);
        (0..4).for_each(|second| health.add(&rows((0..250).map(|i| f64::from(250 * second + i) * 0.004))));
        let expected = [("link_torque_nm", 250.0), ("temperature_c", 2.0), ("brake_current_a", 10.0)];
        assert_eq!(rates(&health), expected.map(|(name, rate)| (name.to_owned(), rate, 0)));
        let age_s = |i: usize| health.channels(Timestamp::UNIX_EPOCH)[i].view(Timestamp::UNIX_EPOCH).age_s.unwrap();
        assert_eq!(age_s(0), 0.0, "of the newest row");
        assert!((age_s(2) - 0.096).abs() < 1e-6, "96 ms before it");
    }

    #[test]
    fn what_did_not_come_is_counted_and_the_time_between_segments_is_not() {
        let mut health = Health::new(250.0);
        let lost = |i: &i32| !(100..107).contains(i);
        health.add(&rows((0..500).filter(lost).map(|i| f64::from(i) * 0.004)));
        health.add(&rows((0..500).map(|i| 4.0 + f64::from(i) * 0.004)));
        let mut empty = rows([6.0, 6.004].into_iter()).into_parts();
        empty.1[1][1] = f64::NAN;
        health.add(&Trace::from_columns(empty.0, empty.1));
        let dropped: Vec<u64> = rates(&health).iter().map(|(_, _, dropped)| *dropped).collect();
        assert_eq!(dropped, [8, 7, 7]);
    }
}
