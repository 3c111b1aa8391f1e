//! Twelve channels as the bench records them: quantised encoders, torque, currents and temperature with noise, steps of a
//! plan.

use jointbench::store::BLOCK_ROWS;
use jointbench_instrument::{Channel, Trace};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Whole counts of each channel, and the counts' size.
pub struct Signals {
    pub channels: Vec<(&'static str, f64)>,
    pub counts: Vec<Vec<i32>>,
}

const TICK_S: f64 = 0.004;
/// One speed or load of the plan.
const SEGMENT_ROWS: usize = 2_000;

impl Signals {
    pub fn generate(rows: usize) -> Signals {
        let channels = vec![
            ("time_s", 1e-5),
            ("motor_position_rad", TAU / 16_384.0),
            ("motor_velocity_rad_s", 2e-3),
            ("motor_current_a", 2.5e-4),
            ("link_position_rad", TAU / 262_144.0),
            ("link_torque_nm", 1e-3),
            ("temperature_c", 2e-3),
            ("brake_current_a", 1e-4),
            ("brake_torque_command_nm", 1e-3),
            ("velocity_setpoint_rad_s", 1e-3),
            ("segment", 1.0),
            ("repeat", 1.0),
        ];
        let mut random = ChaCha8Rng::seed_from_u64(20_261_121);
        let unit = Normal::new(0.0, 1.0).expect("a spread of 1 is valid");
        let mut noise = |sigma: f64| sigma * unit.sample(&mut random);
        let mut counts: Vec<Vec<i32>> = channels.iter().map(|_| Vec::with_capacity(rows)).collect();
        let (mut angle_rad, mut slip_rad_s) = (0.0f64, 0.0f64);
        for row in 0..rows {
            let segment = row / SEGMENT_ROWS;
            let within = (row % SEGMENT_ROWS) as f64 / SEGMENT_ROWS as f64;
            let speed_rad_s = [3.0, -3.0, 12.0, -12.0, 40.0, -40.0, 90.0, -90.0][segment % 8];
            let load_nm = [0.0, 4.0, 9.0, 15.0][segment / 8 % 4];
            let setpoint_rad_s = speed_rad_s * (within * 12.0).min((1.0 - within) * 12.0).min(1.0);
            slip_rad_s = 0.98 * slip_rad_s + noise(0.03);
            let velocity_rad_s = setpoint_rad_s + slip_rad_s;
            angle_rad = (angle_rad + velocity_rad_s * TICK_S).rem_euclid(TAU * 1000.0);
            let ripple_nm = 0.2 * (angle_rad / 50.0).sin() + 0.05 * (6.0 * angle_rad).sin();
            let torque_nm = load_nm * setpoint_rad_s.signum() + ripple_nm;
            let values = [
                row as f64 * TICK_S + noise(4e-5),
                angle_rad + noise(3e-4),
                velocity_rad_s + noise(0.05),
                0.3 * setpoint_rad_s.signum() + 0.004 * velocity_rad_s + torque_nm / 4.0 + noise(0.015),
                angle_rad / 50.0 + 2e-5 * torque_nm + noise(3e-5),
                torque_nm + noise(0.03),
                28.0 + 8.0 * (1.0 - (-(row as f64) / 1e6).exp()) + noise(0.012),
                load_nm / 10.0 + noise(0.002),
                load_nm,
                setpoint_rad_s,
                segment as f64,
                (segment / 32) as f64,
            ];
            for ((column, value), (_, step)) in counts.iter_mut().zip(values).zip(&channels) {
                column.push((value / step).round() as i32);
            }
        }
        // Times increase for any jitter.
        for row in 1..rows {
            counts[0][row] = counts[0][row].max(counts[0][row - 1] + 1);
        }
        Signals { channels, counts }
    }

    /// Rows as the recorder hands them over.
    pub fn trace(&self, rows: std::ops::Range<usize>) -> Trace {
        let channels = self.channels.iter().map(|(name, step)| Channel::counted(*name, *step)).collect();
        let columns = self.counts.iter().zip(&self.channels);
        let columns =
            columns.map(|(column, (_, step))| column[rows.clone()].iter().map(|c| f64::from(*c) * step).collect());
        Trace::from_columns(channels, columns.collect())
    }

    /// Bytes for each row that an ideal code of order 0 needs for the first differences of each block.
    pub fn entropy_floor(&self) -> f64 {
        let bits: f64 = self.counts.iter().map(|column| column.chunks(BLOCK_ROWS).map(block_bits).sum::<f64>()).sum();
        bits / 8.0 / self.counts[0].len() as f64
    }
}

fn block_bits(column: &[i32]) -> f64 {
    let mut seen: HashMap<i32, u32> = HashMap::new();
    for pair in column.windows(2) {
        *seen.entry(pair[1].wrapping_sub(pair[0])).or_default() += 1;
    }
    let all = (column.len() - 1) as f64;
    seen.values().map(|count| f64::from(*count) * (all / f64::from(*count)).log2()).sum()
}
