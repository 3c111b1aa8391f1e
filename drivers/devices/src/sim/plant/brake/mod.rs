//! A hysteresis brake: coil with lag and heat, torque with a rising and a falling branch. The rotor follows its poles
//! and keeps them if the current falls at standstill.
//!
//! Sources: Magtrol HB data sheet EN 04/2025 for resistance, rating and drag. Values marked as assumed are also marked
//! in the physics notes of the bench.

mod branches;
mod heat;
mod poles;

use super::super::data_sheet::brake::{COIL_OHM_25C, RATED_CURRENT_A};
use super::hidden::HiddenBrake;
use super::{CoilSupply, STEP_S};
use branches::Branches;
use heat::Heat;
use poles::Poles;

/// L/R of the coil (assumed: the data sheet gives none).
const COIL_LAG_S: f64 = 0.08;
/// Extra lag of the torque behind the current (assumed).
const TORQUE_LAG_S: f64 = 0.02;
const COPPER_PER_K: f64 = 0.003_93;
/// Drag at 1000 rpm is 0.0918 Nm; a part of it remains at standstill (split assumed).
const DRAG_NM: f64 = 0.03;
const DRAG_NM_S: f64 = 5.9e-4;
/// Wind-up of the rotor before it slips (rad) (assumed).
const WIND_UP_RAD: f64 = 0.01;
const WIND_UP_DAMPING_NM_S: f64 = 1.0;
/// Temperature coefficient of the torque by rotor temperature (assumed).
const PER_K: f64 = -0.0007;
/// Eddy currents: 3 % at 1000 rpm, the maximum at the highest speed of the data sheet (assumed).
const EDDY_PER_RAD_S: f64 = 0.03 / 104.7;
const EDDY_MOST_RAD_S: f64 = 628.0;

pub struct Brake {
    /// Resistance of a bad contact in the coil circuit.
    pub contact_ohm: f64,
    rated_nm: f64,
    hidden: HiddenBrake,
    current_a: f64,
    branches: Branches,
    poles: Poles,
    magnetic_nm: f64,
    wind_up_rad: f64,
    angle_rad: f64,
    heat: Heat,
    coil_gain: f64,
    torque_gain: f64,
}

impl Brake {
    pub fn new(rated_nm: f64, hidden: HiddenBrake) -> Self {
        Self {
            rated_nm,
            branches: Branches::new(hidden.width),
            hidden,
            contact_ohm: 0.0,
            current_a: 0.0,
            poles: Poles::default(),
            magnetic_nm: 0.0,
            wind_up_rad: 0.0,
            angle_rad: 0.0,
            heat: Heat::new(),
            coil_gain: 1.0 - (-STEP_S / COIL_LAG_S).exp(),
            torque_gain: 1.0 - (-STEP_S / TORQUE_LAG_S).exp(),
        }
    }

    pub fn coil_a(&self) -> f64 {
        self.current_a
    }

    pub fn coil_ohm(&self) -> f64 {
        COIL_OHM_25C * (1.0 + COPPER_PER_K * (self.heat.housing_c - 25.0)) + self.contact_ohm
    }

    pub fn housing_c(&self) -> f64 {
        self.heat.housing_c
    }

    /// Final current of a supply: its set value, or the limit by its voltage.
    pub fn settled_a(&self, supply: Option<CoilSupply>) -> f64 {
        supply.map_or(0.0, |supply| supply.current_a.min(supply.voltage_v / self.coil_ohm()))
    }

    /// Torque on the rotor after one step. Without a supply the current decays through the flyback diode with the same
    /// lag.
    pub fn advance(&mut self, supply: Option<CoilSupply>, velocity_rad_s: f64) -> f64 {
        self.current_a += self.coil_gain * (self.settled_a(supply) - self.current_a);
        let field = self.hidden.field(self.current_a / RATED_CURRENT_A);
        let speed_rad_s = velocity_rad_s.abs();
        let eddy = EDDY_PER_RAD_S * speed_rad_s / (1.0 + (speed_rad_s / EDDY_MOST_RAD_S).powi(2));
        let warm = 1.0 + PER_K * (self.heat.rotor_c - 25.0);
        let target_nm =
            self.rated_nm * self.branches.advance(field) * warm * (1.0 + eddy + self.hidden.eddy(speed_rad_s));
        self.magnetic_nm += self.torque_gain * (target_nm - self.magnetic_nm);

        let turned_rad = velocity_rad_s * STEP_S;
        self.angle_rad += turned_rad;
        let cogging_nm = self.rated_nm * self.poles.advance(field, self.angle_rad, turned_rad);

        let holding_nm = self.magnetic_nm + DRAG_NM;
        let before = self.wind_up_rad;
        let slipping = velocity_rad_s.signum() * WIND_UP_RAD;
        self.wind_up_rad = slipping + (before - slipping) * (-turned_rad.abs() / WIND_UP_RAD).exp();
        let winding_rad_s = (self.wind_up_rad - before) / STEP_S;
        let torque_nm = holding_nm * self.wind_up_rad / WIND_UP_RAD
            + WIND_UP_DAMPING_NM_S * winding_rad_s
            + DRAG_NM_S * velocity_rad_s
            + cogging_nm;

        self.heat.advance((torque_nm * velocity_rad_s).max(0.0), self.current_a.powi(2) * self.coil_ohm());
        torque_nm
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::data_sheet::{Joint, brake::RATED_TORQUE_NM};
    use crate::sim::plant::Hidden;

    /// Torque at the end of holds of 2 s at each current, at constant speed.
    fn torque_nm(effects: &[&str], speed_rad_s: f64, currents_a: &[f64]) -> f64 {
        let names: Vec<String> = effects.iter().map(|effect| (*effect).to_owned()).collect();
        let mut brake = Brake::new(RATED_TORQUE_NM, Hidden::draw(Joint::JointA, 5, &names).unwrap().brake);
        let held = |current_a: &f64| {
            let supply = Some(CoilSupply { current_a: *current_a, voltage_v: 45.0 });
            (0..(2.0 / STEP_S) as usize).map(|_| brake.advance(supply, speed_rad_s)).last().unwrap()
        };
        currents_a.iter().map(held).last().unwrap()
    }

    #[test]
    fn a_thick_rotor_brakes_more_the_faster_it_turns() {
        let gain = |effects: &[&str]| torque_nm(effects, 1.5, &[0.4]) / torque_nm(effects, 0.1, &[0.4]);
        assert!((gain(&[]) - 1.0).abs() < 2e-3);
        assert!((1.03..1.09).contains(&gain(&["velocity_dependence"])), "{}", gain(&["velocity_dependence"]));
    }

    #[test]
    fn a_wider_loop_meets_the_other_at_the_top() {
        let fall = |effects: &[&str]| torque_nm(effects, 1.0, &[0.6, 0.3]) - torque_nm(effects, 1.0, &[0.3]);
        assert!(fall(&["hysteresis"]) > 1.3 * fall(&[]), "{} {}", fall(&["hysteresis"]), fall(&[]));
        let top = |effects: &[&str]| torque_nm(effects, 1.0, &[0.6]);
        assert!((top(&["hysteresis"]) - top(&[])).abs() < 1e-6);
    }

    #[test]
    fn iron_that_saturates_early_takes_from_the_top() {
        let share = |current_a: f64| torque_nm(&["saturation"], 1.0, &[current_a]) / torque_nm(&[], 1.0, &[current_a]);
        assert!(share(0.6) < 0.95 && share(0.6) < share(0.2), "{} {}", share(0.2), share(0.6));
    }
}
