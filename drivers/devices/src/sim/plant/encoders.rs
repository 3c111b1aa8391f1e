//! The two encoders of the encoder bench on the motor shaft: S1 is optical, S2 a magnetic ring with its sensor on the
//! stage.

use super::hidden::HiddenEncoder;
use super::{Noise, Signal, curve};
use crate::sim::data_sheet::DataSheet;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Counts per turn, after the quadrature factor of four.
pub const S1_COUNTS: f64 = 16_384.0;
pub const S2_COUNTS: f64 = 262_144.0;

/// Disparity over speed, 0.2811 points/rpm: 64.34 µs.
const DELAY_S: f64 = 64.34e-6;
/// The 27 dB filter adds 10 µs according to the data sheet, and 0.99 µs more (mean of the table).
const DATA_SHEET_FILTER_S: f64 = 10e-6;
const FILTER_DELAY_S: f64 = DATA_SHEET_FILTER_S + 0.99e-6;
/// Table 4.2: points for each rpm over the speed [rpm].
const POINTS_PER_RPM: [(f64, f64); 6] =
    [(-1483.0, 0.2724), (-992.0, 0.2735), (-499.0, 0.2748), (497.0, 0.2902), (990.0, 0.2887), (1478.0, 0.2869)];
/// Table 4.3: delay of the filter beyond its data sheet over the speed [rpm].
const MISSING_DELAY_S: [(f64, f64); 6] =
    [(-1483.0, 0.94e-6), (-992.0, 1.11e-6), (-499.0, 0.69e-6), (497.0, 1.34e-6), (990.0, 1.02e-6), (1478.0, 0.84e-6)];
/// Standard deviation of the moment of a reading, because interrupts of the speed control delay it: that of table 4.3.
const READOUT_S: f64 = 0.225e-6;
/// Shape error of about 250 points: once per turn by eccentricity, twice per turn by tilt (split assumed).
const ECCENTRIC_POINTS: f64 = 190.0;
const TILT_POINTS: f64 = 55.0;
/// Increase of each by shift and tilt of the stage (assumed).
const ECCENTRIC_POINTS_PER_M: f64 = 190.0 / 0.15e-3;
const TILT_POINTS_PER_RAD: f64 = 55.0 / 8.7e-3;
/// Error within a pole pair (assumed); the ring has 64 pole pairs (assumed).
const POLE_POINTS: f64 = 12.0;
const POLE_PAIRS: f64 = 64.0;
/// Half the difference between both directions (assumed). On the bench of the documents, table 4.2 has the whole difference.
const HYSTERESIS_POINTS: f64 = 6.0;
/// Largest offset of the zero after power-up (assumed).
const STARTUP_POINTS: f64 = 30.0;
/// Standard deviation of a normal deviate that is clipped at ±1: √(0.19875 + 0.31731).
const STARTUP_SPREAD: f64 = 0.71837;

/// Limits beyond which the period consistency is lost: table 4.4, in m and rad, of radial shift, axial shift, rotation
/// about the chip's normal, tilt. The vertical shift has no limit.
const RADIAL_M: [f64; 2] = [-0.25e-3, 0.3e-3];
const AXIAL_M: f64 = 0.65e-3;
const ROTATION_RAD: f64 = 1.0 * TAU / 360.0;
const TILT_RAD: f64 = 1.5 * TAU / 360.0;

/// Pose of the sensor of S2 on the stage: x radial, y vertical, z axial (m), then rotations about them (rad).
#[derive(Debug, Clone, Copy, Default)]
pub struct Pose {
    pub shift_m: [f64; 3],
    pub rotation_rad: [f64; 3],
}

/// The true behaviour of encoder S2 with its sensor at the nominal pose.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EncoderTruth {
    /// Total delay of the position, filter included.
    pub delay_s: f64,
    /// Contribution of the filter, 0 if it is off.
    pub filter_delay_s: f64,
    /// Offset by mounting, and since power-up.
    pub offset_rad: f64,
    /// Standard deviation of that offset over power-ups.
    pub startup_spread_rad: f64,
    /// Half the difference between both directions.
    pub hysteresis_rad: f64,
    /// Amplitude of the error once per turn.
    pub eccentricity_rad: f64,
    /// Amplitude of the error twice per turn.
    pub tilt_rad: f64,
    /// Pole pairs of the ring.
    pub pole_pairs: f64,
    /// Radial shift without eccentricity.
    pub best_radial_m: f64,
    /// Limits of period consistency: radial shift in both directions, axial shift, rotation and tilt.
    pub radial_m: [f64; 2],
    /// Axial shift at which periods are lost.
    pub axial_m: f64,
    /// Rotation at which periods are lost, to either side.
    pub rotation_rad: f64,
    /// Tilt at which periods are lost, to either side.
    pub lost_tilt_rad: f64,
}

pub struct Encoders {
    pub pose: Pose,
    pub filtered: bool,
    /// Exactly the delays of tables 4.2 and 4.3, and their jitter.
    is_exact: bool,
    noise: Noise,
    hidden: HiddenEncoder,
    mounting_points: f64,
    startup_points: f64,
    phase_rad: f64,
    angle_rad: f64,
    travelled_rad: f64,
    drag_rad: f64,
}

impl Encoders {
    pub fn new(sheet: &DataSheet, noise: Noise, hidden: HiddenEncoder) -> Self {
        // An exact bench starts with exactly the offset of its mounting.
        let startup_points = if sheet.is_exact { 0.0 } else { STARTUP_POINTS * noise.trait_of(Signal::EncoderStartup) };
        Self {
            pose: Pose::default(),
            filtered: false,
            is_exact: sheet.is_exact,
            noise,
            hidden,
            mounting_points: sheet.mounting_points,
            startup_points,
            phase_rad: TAU * noise.trait_of(Signal::EncoderPhase),
            angle_rad: 0.0,
            travelled_rad: 0.0,
            drag_rad: 0.0,
        }
    }

    /// Updates the magnetic ring after one step of the shaft: its reading lags after a reversal.
    pub fn advance(&mut self, angle_rad: f64) {
        self.travelled_rad += (angle_rad - self.angle_rad).abs();
        self.angle_rad = angle_rad;
        let half_rad = self.hysteresis_points() / S2_COUNTS * TAU;
        self.drag_rad = self.drag_rad.clamp(angle_rad - half_rad, angle_rad + half_rad);
    }

    /// S2 was switched off and on.
    pub fn power_cycle_s2(&mut self, step: u64) {
        self.startup_points = STARTUP_POINTS * self.noise.at(Signal::EncoderStartup, step).clamp(-1.0, 1.0);
    }

    pub fn s1_counts(&self, angle_rad: f64) -> i64 {
        (angle_rad / TAU * S1_COUNTS).floor() as i64
    }

    pub fn s2_counts(&self, velocity_rad_s: f64, step: u64) -> i64 {
        let slipped_rad = self.hidden.slipped_points(self.travelled_rad) / S2_COUNTS * TAU;
        let angle_rad = self.drag_rad - self.delay_at(velocity_rad_s, step) * velocity_rad_s + slipped_rad;
        let points = S2_COUNTS * angle_rad / TAU;
        let error_points = self.shape_points(angle_rad) + self.hidden.error_points(angle_rad);
        (points + error_points + self.offset_points()).floor() as i64
    }

    fn offset_points(&self) -> f64 {
        self.mounting_points + self.startup_points
    }

    fn hysteresis_points(&self) -> f64 {
        if self.is_exact { 0.0 } else { HYSTERESIS_POINTS }
    }

    /// Delay of one reading.
    fn delay_at(&self, velocity_rad_s: f64, step: u64) -> f64 {
        if !self.is_exact {
            return self.delay_s();
        }
        let rpm = velocity_rad_s / TAU * 60.0;
        let of = |table: &[(f64, f64); 6]| curve::at(table, rpm.clamp(table[0].0, table[5].0));
        let filter_s = if self.filtered { DATA_SHEET_FILTER_S + of(&MISSING_DELAY_S) } else { 0.0 };
        of(&POINTS_PER_RPM) * 60.0 / S2_COUNTS + filter_s + READOUT_S * self.noise.at(Signal::Readout, step)
    }

    /// Mean over the speeds.
    fn delay_s(&self) -> f64 {
        if self.filtered { DELAY_S + FILTER_DELAY_S } else { DELAY_S }
    }

    fn shape_points(&self, angle_rad: f64) -> f64 {
        let eccentric = ECCENTRIC_POINTS + ECCENTRIC_POINTS_PER_M * self.pose.shift_m[0];
        let tilt = TILT_POINTS + TILT_POINTS_PER_RAD * self.pose.rotation_rad[0].hypot(self.pose.rotation_rad[1]);
        eccentric * (angle_rad + self.phase_rad).sin()
            + tilt * (2.0 * angle_rad - self.phase_rad).cos()
            + POLE_POINTS * (POLE_PAIRS * angle_rad).sin()
    }

    pub fn truth(&self) -> EncoderTruth {
        let rad = |points: f64| points / S2_COUNTS * TAU;
        EncoderTruth {
            delay_s: self.delay_s(),
            filter_delay_s: self.delay_s() - DELAY_S,
            offset_rad: rad(self.offset_points()),
            startup_spread_rad: rad(STARTUP_SPREAD * STARTUP_POINTS),
            hysteresis_rad: rad(self.hysteresis_points()),
            eccentricity_rad: rad(ECCENTRIC_POINTS),
            tilt_rad: rad(TILT_POINTS),
            pole_pairs: POLE_PAIRS,
            best_radial_m: -ECCENTRIC_POINTS / ECCENTRIC_POINTS_PER_M,
            radial_m: RADIAL_M,
            axial_m: AXIAL_M,
            rotation_rad: ROTATION_RAD,
            lost_tilt_rad: TILT_RAD,
        }
    }

    /// The period consistency that S2 monitors itself.
    pub fn periods_are_consistent(&self) -> bool {
        let Pose { shift_m: [radial_m, _, axial_m], rotation_rad: [a_rad, b_rad, about_rad] } = self.pose;
        (RADIAL_M[0]..=RADIAL_M[1]).contains(&radial_m)
            && axial_m <= AXIAL_M
            && about_rad.abs() <= ROTATION_RAD
            && a_rad.abs().max(b_rad.abs()) <= TILT_RAD
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::data_sheet::Joint;
    use crate::sim::plant::Hidden;
    use crate::sim::plant::hidden::HiddenEffect;

    /// Error in points of a ring with a hidden effect, relative to a ring without, at an angle after `turns`.
    fn hidden_points(effect: &str, turns: f64, angle_rad: f64) -> (f64, HiddenEffect) {
        let hidden = Hidden::draw(Joint::EncoderShaft, 5, &[effect.to_owned()]).unwrap();
        let counts = |hidden: HiddenEncoder| {
            let mut encoders = Encoders::new(&Joint::EncoderShaft.into(), Noise::new(5), hidden);
            encoders.advance(turns * TAU);
            encoders.advance(angle_rad);
            encoders.s2_counts(0.0, 0) as f64
        };
        (counts(hidden.encoder) - counts(HiddenEncoder::default()), hidden.described().remove(0))
    }

    /// Mean difference in points at a speed, over the readings of a turn.
    fn difference(encoders: &mut Encoders, rpm: f64) -> f64 {
        let readings: u64 = 4000;
        let sum: f64 = (0..readings)
            .map(|step| {
                let angle_rad = step as f64 / readings as f64 * TAU;
                encoders.advance(angle_rad);
                encoders.s2_counts(rpm / 60.0 * TAU, step) as f64 + 0.5 - angle_rad / TAU * S2_COUNTS
            })
            .sum();
        sum / readings as f64 - encoders.offset_points()
    }

    #[test]
    fn the_bench_of_the_documents_has_the_delays_of_its_tables() {
        let mut encoders =
            Encoders::new(&DataSheet::from(Joint::EncoderShaft).exact(), Noise::new(5), HiddenEncoder::default());
        let without: Vec<f64> = POINTS_PER_RPM.iter().map(|(rpm, _)| difference(&mut encoders, *rpm)).collect();
        encoders.filtered = true;
        let with: Vec<f64> = POINTS_PER_RPM.iter().map(|(rpm, _)| difference(&mut encoders, *rpm)).collect();
        // Disparity of table 4.2 and real shift of table 4.3, in rounded points.
        let tables = [(404.0, 70.9), (271.0, 48.2), (137.0, 23.3), (-144.0, -24.6), (-285.0, -47.7), (-424.0, -70.0)];
        for ((without, with), (disparity, shift)) in without.iter().zip(&with).zip(tables) {
            assert!((without - disparity).abs() < 1.0, "{without} points for {disparity}");
            assert!((with - without - shift).abs() < 0.4, "{} points for {shift}", with - without);
        }
    }

    #[test]
    fn other_benches_have_one_delay_without_jitter() {
        let encoders = Encoders::new(&Joint::EncoderShaft.into(), Noise::new(5), HiddenEncoder::default());
        for step in 0..20 {
            assert_eq!(encoders.delay_at(100.0, step), DELAY_S);
            assert_eq!(encoders.delay_at(-20.0, step), DELAY_S);
        }
    }

    #[test]
    fn lobes_are_waves_over_the_turn() {
        for angle_rad in [0.1, 1.0, 2.0, 4.0] {
            let (points, truth) = hidden_points("harmonic_n", 0.0, angle_rad);
            let [size, harmonic, phase_rad] = ["points", "harmonic", "phase_rad"].map(|name| truth.parameters[name]);
            let expected = size * (harmonic * angle_rad + phase_rad).sin();
            assert!((points - expected).abs() < 2.0, "{points} at {angle_rad} rad, expected {expected}");
        }
    }

    #[test]
    fn a_loose_ring_gives_way_once() {
        let (before, truth) = hidden_points("slip", 2.0, 0.0);
        assert_eq!(before, 0.0);
        let (after, _) = hidden_points("slip", truth.parameters["after_turns"], 0.0);
        assert!((after - truth.parameters["points"]).abs() < 5.0, "{after} points of {truth:?}");
    }
}
