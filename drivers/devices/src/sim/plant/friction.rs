//! Bristle friction on the rotor (Canudas de Wit, Olsson, Åström, Lischinsky 1995), stepped exactly for constant
//! velocity.

use super::STEP_S;

/// Deflection of the rotor at which the bristles break away, at Coulomb torque (rad).
const BREAK_RAD: f64 = 0.002;
/// Damping ratio of the rotor on its bristles.
const BRISTLE_DAMPING: f64 = 0.4;

pub struct Friction {
    pub coulomb_nm: f64,
    pub viscous_nm_s: f64,
    pub stiffness_nm_rad: f64,
    damping_nm_s: f64,
    deflection_rad: f64,
}

impl Friction {
    pub fn new(coulomb_nm: f64, viscous_nm_s: f64, inertia_kg_m2: f64) -> Self {
        let stiffness_nm_rad = coulomb_nm / BREAK_RAD;
        let damping_nm_s = 2.0 * BRISTLE_DAMPING * (stiffness_nm_rad * inertia_kg_m2).sqrt();
        Self { coulomb_nm, viscous_nm_s, stiffness_nm_rad, damping_nm_s, deflection_rad: 0.0 }
    }

    /// Torque of the bristles after one step at `velocity_rad_s`, with the holding torque `grip_nm`.
    pub fn advance(&mut self, velocity_rad_s: f64, grip_nm: f64) -> f64 {
        let before = self.deflection_rad;
        let rate = self.stiffness_nm_rad * velocity_rad_s.abs() / grip_nm;
        let turned = rate * STEP_S;
        if turned > 1e-9 {
            let slipping = velocity_rad_s.signum() * grip_nm / self.stiffness_nm_rad;
            self.deflection_rad = slipping + (before - slipping) * (-turned).exp();
        } else {
            self.deflection_rad += velocity_rad_s * STEP_S;
        }
        let bending_rad_s = (self.deflection_rad - before) / STEP_S;
        self.stiffness_nm_rad * self.deflection_rad + self.damping_nm_s * bending_rad_s
    }
}
