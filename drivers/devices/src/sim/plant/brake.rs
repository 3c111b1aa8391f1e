//! A hysteresis brake: coil with lag and heat, torque with a rising and a falling branch, a rotor that follows its poles.
//!
//! Sources: Magtrol HB data sheet EN 04/2025 for resistance, rating, drag; everything marked assumed is so in the bench's
//! physics notes as well.

use super::super::data_sheet::brake::{COIL_OHM_25C, RATED_CURRENT_A, RATED_TORQUE_NM};
use super::{AMBIENT_C, CoilSupply, STEP_S};

/// L/R of the coil (assumed: the data sheet gives none).
const COIL_LAG_S: f64 = 0.08;
/// Extra lag of the torque behind the current (assumed).
const TORQUE_LAG_S: f64 = 0.02;
const COPPER_PER_K: f64 = 0.003_93;
/// Drag at 1000 rpm is 0.0918 Nm; a part of it stays at standstill (split assumed).
const DRAG_NM: f64 = 0.03;
const DRAG_NM_S: f64 = 5.9e-4;
/// Housing: 75 K at 350 W, and in 300 s at 1200 W.
const THERMAL_K_PER_W: f64 = 0.214;
const THERMAL_J_PER_K: f64 = 4060.0;
/// Rising branch, torque over current, both as fractions of the rating (assumed, S-shaped, +18 % at 130 %).
const RISING: [(f64, f64); 13] = [
    (0.0, 0.0),
    (0.1, 0.03),
    (0.2, 0.09),
    (0.3, 0.19),
    (0.4, 0.33),
    (0.5, 0.47),
    (0.6, 0.61),
    (0.7, 0.74),
    (0.8, 0.85),
    (0.9, 0.94),
    (1.0, 1.00),
    (1.15, 1.10),
    (1.3, 1.18),
];
/// The falling branch lies this far above the rising one at half the rating (assumed).
const BRANCH_GAP: f64 = 0.06;
/// Half width of the play between the branches, of the rated current (assumed).
const PLAY: f64 = 0.025;
/// Wind-up of the rotor before it slips [rad] (assumed).
const WIND_UP_RAD: f64 = 0.01;
const WIND_UP_DAMPING_NM_S: f64 = 1.0;
/// Torque over temperature and over speed (assumed).
const PER_K: f64 = -0.0007;
const PER_RAD_S: f64 = 0.03 / 104.7;

pub struct Brake {
    /// Of a bad contact in the coil's circuit.
    pub contact_ohm: f64,
    current_a: f64,
    /// Play between the branches: follows the current at a distance.
    memory_a: f64,
    magnetic_nm: f64,
    wind_up_rad: f64,
    housing_c: f64,
    coil_gain: f64,
    torque_gain: f64,
}

impl Brake {
    pub fn new() -> Self {
        Self {
            contact_ohm: 0.0,
            current_a: 0.0,
            memory_a: -PLAY * RATED_CURRENT_A,
            magnetic_nm: 0.0,
            wind_up_rad: 0.0,
            housing_c: AMBIENT_C,
            coil_gain: 1.0 - (-STEP_S / COIL_LAG_S).exp(),
            torque_gain: 1.0 - (-STEP_S / TORQUE_LAG_S).exp(),
        }
    }

    pub fn coil_a(&self) -> f64 {
        self.current_a
    }

    pub fn coil_ohm(&self) -> f64 {
        COIL_OHM_25C * (1.0 + COPPER_PER_K * (self.housing_c - 25.0)) + self.contact_ohm
    }

    /// Current that a supply drives in the end: what it is set to, or what its voltage reaches.
    pub fn settled_a(&self, supply: Option<CoilSupply>) -> f64 {
        supply.map_or(0.0, |supply| supply.current_a.min(supply.voltage_v / self.coil_ohm()))
    }

    /// Torque against the rotor after one step. Without a supply the current dies in the flyback diode with the same lag.
    pub fn advance(&mut self, supply: Option<CoilSupply>, velocity_rad_s: f64) -> f64 {
        self.current_a += self.coil_gain * (self.settled_a(supply) - self.current_a);
        let play_a = PLAY * RATED_CURRENT_A;
        self.memory_a = self.memory_a.clamp(self.current_a - play_a, self.current_a + play_a);
        let warm = 1.0 + PER_K * (self.housing_c - 25.0);
        let target_nm = RATED_TORQUE_NM * self.branch(play_a) * warm * (1.0 + PER_RAD_S * velocity_rad_s.abs());
        self.magnetic_nm += self.torque_gain * (target_nm - self.magnetic_nm);

        let holding_nm = self.magnetic_nm + DRAG_NM;
        let before = self.wind_up_rad;
        let turned = velocity_rad_s.abs() * STEP_S / WIND_UP_RAD;
        let slipping = velocity_rad_s.signum() * WIND_UP_RAD;
        self.wind_up_rad = slipping + (before - slipping) * (-turned).exp();
        let winding_rad_s = (self.wind_up_rad - before) / STEP_S;
        let torque_nm = holding_nm * self.wind_up_rad / WIND_UP_RAD
            + WIND_UP_DAMPING_NM_S * winding_rad_s
            + DRAG_NM_S * velocity_rad_s;

        let heat_w = (torque_nm * velocity_rad_s).max(0.0) + self.current_a.powi(2) * self.coil_ohm();
        let lost_w = (self.housing_c - AMBIENT_C) / THERMAL_K_PER_W;
        self.housing_c += (heat_w - lost_w) / THERMAL_J_PER_K * STEP_S;
        torque_nm
    }

    /// Torque as a fraction of the rating: on the rising branch, the falling one, or between them.
    fn branch(&self, play_a: f64) -> f64 {
        let x = self.current_a / RATED_CURRENT_A;
        let upper = RISING.partition_point(|(at, _)| *at < x).clamp(1, RISING.len() - 1);
        let ((x0, y0), (x1, y1)) = (RISING[upper - 1], RISING[upper]);
        let rising = y0 + (y1 - y0) * (x - x0) / (x1 - x0);
        // 0 on the way up, 1 on the way down; the branches meet at zero and at the rating.
        let fallen = (self.memory_a - self.current_a + play_a) / (2.0 * play_a);
        rising + fallen * BRANCH_GAP * 4.0 * x.clamp(0.0, 1.0) * (1.0 - x.clamp(0.0, 1.0))
    }
}
