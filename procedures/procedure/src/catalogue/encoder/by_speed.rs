//! Rows by speed: encoder difference, delay, and delay beyond the expected one at each speed.

use crate::findings::{Solved, quantity, solve, t95};
use crate::identification::{Axis, Figure, Form, Mark, Quantity, Series};
use crate::thresholds::SAME_SET_POINT;
use std::f64::consts::TAU;

/// Speed of a sweep, and its mean encoder difference.
pub type Point = (f64, f64);

/// Delays that are known before the run.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    /// The same encoder without its filter, from an equal run with the same uncertainty.
    pub without_filter_s: f64,
    /// Half the difference of this delay between the directions.
    pub half_difference_s: f64,
    /// The filter according to the data sheet.
    pub filter_s: f64,
}

impl Known {
    fn without_s(&self, v: f64) -> f64 {
        self.without_filter_s + self.half_difference_s * v.signum()
    }

    /// With the filter of the data sheet, in the positive and the negative direction.
    fn expected_s(&self) -> [f64; 2] {
        [1.0, -1.0].map(|v| self.without_s(v) + self.filter_s)
    }
}

/// The straight line of each direction: offset, half the hysteresis against the motion, delay, and half the difference
/// of the delay between the directions.
#[derive(Debug, Clone, Copy)]
pub struct Lines {
    pub solved: Solved<4>,
    /// Whether the difference is fitted. Otherwise it is 0.
    pub differ: bool,
    /// The difference and half its interval, fitted or not. `None`: too few sweeps.
    pub difference: Option<[f64; 2]>,
}

impl Lines {
    /// The delay depends on the direction only if the interval of the difference does not contain 0. `None`: too few
    /// speeds.
    pub fn of(points: &[Point]) -> Option<Self> {
        let means: Vec<f64> = points.iter().map(|(_, mean)| *mean).collect();
        let row = |v: f64| [1.0, -v.signum(), -v];
        let equal: Solved<3> = solve(&points.iter().map(|(v, _)| row(*v)).collect::<Vec<_>>(), &means)?;
        let rows: Vec<[f64; 4]> = points
            .iter()
            .map(|(v, _)| {
                let [one, sign, speed] = row(*v);
                [one, sign, speed, -v.abs()]
            })
            .collect();
        let apart = solve(&rows, &means);
        let difference = apart.map(|apart| [apart.values[3], apart.reach[3]]);
        let padded = |[a, b, c]: [f64; 3]| [a, b, c, 0.0];
        let equal = Solved { values: padded(equal.values), reach: padded(equal.reach) };
        let differ = apart.filter(|apart| apart.values[3].abs() > apart.reach[3]);
        Some(Self { solved: differ.unwrap_or(equal), differ: differ.is_some(), difference })
    }

    /// Encoder difference of the lines at a speed.
    pub fn at(&self, v: f64) -> f64 {
        let [offset_rad, hysteresis_rad, delay_s, half_difference_s] = self.solved.values;
        offset_rad - hysteresis_rad * v.signum() - delay_s * v - half_difference_s * v.abs()
    }
}

/// All sweeps of one set-point. The half widths of 95 % intervals come from the scatter around the straight line.
struct Speed {
    rad_s: f64,
    /// Encoder difference without the offset.
    disparity_rad: f64,
    /// Half width for the mean of the sweeps alone.
    reach_rad: f64,
}

/// All set-points, with the lines through them.
pub struct BySpeed<'a> {
    solved: &'a Solved<4>,
    speeds: Vec<Speed>,
}

impl<'a> BySpeed<'a> {
    pub fn of(points: &[Point], lines: &'a Lines) -> Self {
        let solved = &lines.solved;
        let offset_rad = solved.values[0];
        let rest = |(v, mean): &Point| mean - lines.at(*v);
        let freedom = points.len() as f64 - if lines.differ { 4.0 } else { 3.0 };
        let scatter_rad = (points.iter().map(|point| rest(point).powi(2)).sum::<f64>() / freedom).sqrt();
        let mut sorted = points.to_vec();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let is_same = |a: &Point, b: &Point| (b.0 - a.0).abs() < SAME_SET_POINT * a.0.abs();
        let speed = |repeats: &[Point]| {
            let n = repeats.len() as f64;
            Speed {
                rad_s: repeats.iter().map(|(v, _)| v).sum::<f64>() / n,
                disparity_rad: repeats.iter().map(|(_, mean)| mean - offset_rad).sum::<f64>() / n,
                reach_rad: t95(freedom) * scatter_rad / n.sqrt(),
            }
        };
        let speeds = sorted.chunk_by(is_same).map(speed).collect();
        Self { solved, speeds }
    }

    /// Delay at a speed without the hysteresis, and the half width of its interval.
    fn delay(&self, speed: &Speed) -> [f64; 2] {
        let [offset_reach, hysteresis_reach, ..] = self.solved.reach;
        let moved_rad = speed.disparity_rad + self.solved.values[1] * speed.rad_s.signum();
        let reach_rad = speed.reach_rad.hypot(offset_reach).hypot(hysteresis_reach);
        [-moved_rad / speed.rad_s, reach_rad / speed.rad_s.abs()]
    }

    /// Delay at each speed minus an expected one for the positive and the negative direction, whose interval is that of
    /// the lines.
    fn beyond(&self, expected_s: [f64; 2]) -> impl Iterator<Item = (f64, f64)> {
        self.speeds.iter().map(move |speed| {
            let [here_s, reach_s] = self.delay(speed);
            let expected_s = expected_s[usize::from(speed.rad_s < 0.0)];
            (here_s - expected_s, reach_s.hypot(self.solved.reach[2]).hypot(self.solved.reach[3]))
        })
    }

    /// Mean of the delays of all speeds, and the half width of its interval.
    pub fn mean_delay(&self) -> [f64; 2] {
        let count = self.speeds.len() as f64;
        let mean_s = self.speeds.iter().map(|speed| -speed.disparity_rad / speed.rad_s).sum::<f64>() / count;
        let offset_s = self.solved.reach[0] * self.speeds.iter().map(|speed| 1.0 / speed.rad_s).sum::<f64>() / count;
        let sweeps_s = self.speeds.iter().map(|speed| (speed.reach_rad / speed.rad_s).powi(2)).sum::<f64>().sqrt();
        [mean_s, offset_s.hypot(sweeps_s / count)]
    }

    /// Lowest and highest delay beyond the expected one of encoder and filter.
    pub fn missing_range_s(&self, known: Known) -> [f64; 2] {
        let missing = self.beyond(known.expected_s()).map(|(missing_s, _)| missing_s);
        missing.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s| [low.min(s), high.max(s)])
    }

    /// In radians and, if the encoder's `point_rad` is known, in points.
    pub fn quantities(&self, point_rad: Option<f64>, known: Option<Known>) -> Vec<Quantity> {
        let mut quantities = Vec::new();
        let (name, title, expected_s) = match known {
            Some(known) => (
                "missing_delay",
                "Filter delay at this speed without hysteresis, beyond the data sheet",
                known.expected_s(),
            ),
            None => (
                "delay_difference",
                "Delay at this speed without hysteresis, beyond the mean delay",
                [self.solved.values[2]; 2],
            ),
        };
        for (i, (speed, (beyond_s, reach_s))) in self.speeds.iter().zip(self.beyond(expected_s)).enumerate() {
            let of = |[name, symbol, title, unit]: [&str; 4], value: f64, reach: Option<f64>| {
                let words = [&format!("{name}_{}", i + 1), symbol, title, unit];
                let ends = reach.map(|reach| [value - reach, value + reach]);
                quantity(words, value, ends).in_configuration(&format!("{:+.1} rad/s", speed.rad_s))
            };
            let reach_rad = speed.reach_rad.hypot(self.solved.reach[0]);
            let (here_s, here_reach_s) = (-speed.disparity_rad / speed.rad_s, reach_rad / speed.rad_s.abs());
            let difference = "Encoder difference without the offset";
            quantities.extend([
                of(["speed", "ω", "Measured speed", "rad/s"], speed.rad_s, None),
                of(["disparity", "Δ", difference, "rad"], speed.disparity_rad, Some(reach_rad)),
                of(["delay", "t_ω", "Delay at this speed", "s"], here_s, Some(here_reach_s)),
            ]);
            if let Some(point_rad) = point_rad {
                let points = |rad: f64| rad / point_rad;
                // One revolution per minute is TAU / 60 rad/s.
                let per_rpm = |delay_s: f64| points(delay_s * TAU / 60.0);
                let (name, value) = ("disparity_points", points(speed.disparity_rad));
                quantities.push(of([name, "", &format!("{difference} (points)"), ""], value, Some(points(reach_rad))));
                let (name, title) = ("points_per_rpm", "Encoder difference over speed (points per rpm)");
                quantities.push(of([name, "", title, ""], per_rpm(here_s), Some(per_rpm(here_reach_s))));
            }
            quantities.push(of([name, "", title, "s"], beyond_s, Some(reach_s)));
        }
        quantities
    }

    /// Table 4.3: shift by the filter, expected and measured.
    pub fn figure(&self, known: Known) -> Figure {
        let speeds: Vec<f64> = self.speeds.iter().map(|speed| speed.rad_s).collect();
        let shift = |speed: &Speed| -(self.delay(speed)[0] - known.without_s(speed.rad_s)) * speed.rad_s;
        let measured = self.speeds.iter().map(shift).collect();
        let expected = speeds.iter().map(|speed| -known.filter_s * speed).collect();
        Figure {
            name: "filter_shift".into(),
            title: "Shift by the filter over speed".into(),
            form: Form::Cartesian,
            x: Axis::of("Speed", "rad/s"),
            y: Axis::of("Shift of the encoder difference", "rad"),
            series: vec![
                Series::new("measured", Mark::Points, speeds.clone(), measured),
                Series::new("data sheet", Mark::Line, speeds, expected),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RPM: f64 = TAU / 60.0;
    const POINT_RAD: f64 = TAU / 262_144.0;
    /// Tables 4.2 and 4.3: speed, disparity and error per speed without the filter; shift by the filter, missing delay.
    const TABLES: [[f64; 5]; 6] = [
        [-1483.0, 404.0, 0.2724, 70.9, 0.94e-6],
        [-992.0, 271.0, 0.2735, 48.2, 1.11e-6],
        [-499.0, 137.0, 0.2748, 23.3, 0.69e-6],
        [497.0, -144.0, 0.2902, -24.6, 1.34e-6],
        [990.0, -285.0, 0.2887, -47.7, 1.02e-6],
        [1478.0, -424.0, 0.2869, -70.0, 0.84e-6],
    ];

    /// Lines with given values, and the intervals of a fit with one delay.
    fn lines(points: &[Point], [offset_rad, hysteresis_rad, delay_s]: [f64; 3]) -> Lines {
        let rows: Vec<[f64; 3]> = points.iter().map(|(v, _)| [1.0, -v.signum(), -v]).collect();
        let means: Vec<f64> = points.iter().map(|(_, mean)| *mean).collect();
        let [a, b, c] = solve(&rows, &means).unwrap().reach;
        let solved = Solved { values: [offset_rad, hysteresis_rad, delay_s, 0.0], reach: [a, b, c, 0.0] };
        Lines { solved, differ: false, difference: None }
    }

    fn value(found: &[Quantity], name: &str) -> f64 {
        found.iter().find(|quantity| quantity.name == name).unwrap_or_else(|| panic!("no {name}")).value
    }

    /// Both repeats scatter by 2 µrad, so that the line has an interval.
    fn twice(rows: impl Iterator<Item = Point>) -> Vec<Point> {
        rows.flat_map(|(v, mean)| [(v, mean + 2e-6), (v, mean - 2e-6)]).collect()
    }

    #[test]
    fn the_rows_of_table_4_2_follow_from_its_differences() {
        let offset_rad = 1437.0 * POINT_RAD;
        let points = twice(TABLES.iter().map(|[rpm, points, ..]| (rpm * RPM, offset_rad + points * POINT_RAD)));
        // The table has its own offset.
        let solved = lines(&points, [offset_rad, 0.0, 0.2811 * POINT_RAD / RPM]);
        let found = BySpeed::of(&points, &solved).quantities(Some(POINT_RAD), None);
        for (i, [rpm, points, per_rpm, ..]) in (1..).zip(TABLES) {
            assert!((value(&found, &format!("disparity_points_{i}")) - points).abs() < 1e-6);
            // The document rounds speeds and differences to whole numbers.
            assert!((value(&found, &format!("points_per_rpm_{i}")) - per_rpm).abs() < 1e-3, "{rpm} rpm");
            let difference_s = (-points / rpm - 0.2811) * POINT_RAD / RPM;
            assert!((value(&found, &format!("delay_difference_{i}")) - difference_s).abs() < 1e-12, "{rpm} rpm");
        }
        assert!(BySpeed::of(&points, &solved).quantities(None, None).iter().all(|one| !one.name.contains("points")));
    }

    /// Without a given offset, the delays of both directions of table 4.2 are fitted apart.
    #[test]
    fn directions_with_different_delays_do_not_shift_the_offset() {
        let offset_rad = 1437.0 * POINT_RAD;
        // The quotients of the table have more digits than its differences.
        let mean_rad = |rpm: f64, per_rpm: f64| offset_rad - per_rpm * rpm * POINT_RAD;
        let points = twice(TABLES.iter().map(|[rpm, _, per_rpm, ..]| (rpm * RPM, mean_rad(*rpm, *per_rpm))));
        let lines = Lines::of(&points).unwrap();
        assert!(lines.differ && (lines.solved.values[0] - offset_rad).abs() < POINT_RAD, "{lines:?}");
        let by_speed = BySpeed::of(&points, &lines);
        let [mean_s, reach_s] = by_speed.mean_delay();
        assert!((mean_s - 64.34e-6).abs() < reach_s && reach_s < 0.3e-6, "{mean_s:e} ± {reach_s:e}");
        let found = by_speed.quantities(Some(POINT_RAD), None);
        for (i, [rpm, _, per_rpm, ..]) in (1..).zip(TABLES) {
            let name = format!("points_per_rpm_{i}");
            let [low, high] = found.iter().find(|one| one.name == name).unwrap().ci95.unwrap();
            assert!(low < per_rpm && per_rpm < high, "{rpm} rpm: {low} to {high}");
        }
    }

    #[test]
    fn directions_with_equal_delays_have_one() {
        let points = twice(TABLES.iter().map(|[rpm, ..]| (rpm * RPM, 0.01 - 6e-5 * rpm * RPM - 2e-5 * rpm.signum())));
        let lines = Lines::of(&points).unwrap();
        assert!(!lines.differ && lines.solved.values[3] == 0.0 && lines.difference.unwrap()[1] > 0.0, "{lines:?}");
        assert!((lines.solved.values[2] - 6e-5).abs() < 1e-9, "{lines:?}");
    }

    #[test]
    fn the_missing_delay_of_table_4_3_is_the_shift_beyond_the_data_sheet() {
        let (delay_s, hysteresis_rad) = (64.34e-6, 6.0 * POINT_RAD);
        let mean = |[rpm, _, _, shift, _]: &[f64; 5]| {
            let rad_s = rpm * RPM;
            (rad_s, shift * POINT_RAD - delay_s * rad_s - hysteresis_rad * rad_s.signum())
        };
        let points = twice(TABLES.iter().map(mean));
        // The scatter of the table over speed belongs to the missing delay, not to offset and hysteresis.
        let solved = lines(&points, [0.0, hysteresis_rad, delay_s + 10.99e-6]);
        let known = Known { without_filter_s: delay_s, half_difference_s: 0.0, filter_s: 10e-6 };
        let by_speed = BySpeed::of(&points, &solved);
        let found = by_speed.quantities(Some(POINT_RAD), Some(known));
        for (i, [rpm, _, _, _, missing_s]) in (1..).zip(TABLES) {
            let name = format!("missing_delay_{i}");
            assert!((value(&found, &name) - missing_s).abs() < 0.03e-6, "{rpm} rpm: {:e}", value(&found, &name));
            let [low, high] = found.iter().find(|one| one.name == name).unwrap().ci95.unwrap();
            assert!(low < missing_s && missing_s < high, "{rpm} rpm: {low:e} to {high:e}");
        }
        let [low, high] = by_speed.missing_range_s(known);
        assert!((low - 0.69e-6).abs() < 0.03e-6 && (high - 1.34e-6).abs() < 0.03e-6, "{low:e} {high:e}");
        assert!(found.iter().all(|one| !one.name.starts_with("delay_difference")));
        let figure = by_speed.figure(known);
        assert!((figure.series[0].y[0] / POINT_RAD - 70.9).abs() < 0.01, "{figure:?}");
        assert!((figure.series[1].y[0] / POINT_RAD - 64.8).abs() < 0.1, "{figure:?}");
    }
}
