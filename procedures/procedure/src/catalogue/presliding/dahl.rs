//! Parameters of the Dahl model.

use super::loops::Swings;

/// Compliance [rad/Nm], Coulomb torque (Nm) and a constant bias torque (Nm).
#[derive(Debug, Clone, Copy)]
pub struct Dahl {
    pub compliance: f64,
    pub coulomb_nm: f64,
    pub bias_nm: f64,
}

impl Dahl {
    pub fn stiffness(self) -> f64 {
        1.0 / self.compliance
    }

    /// τ_c/k: the displacement at which a linear spring would reach the Coulomb torque.
    pub fn reach_rad(self) -> f64 {
        self.compliance * self.coulomb_nm
    }

    /// A size of each parameter, for derivatives.
    pub fn sizes(self, top_nm: f64) -> [f64; 3] {
        [self.compliance, self.coulomb_nm, top_nm]
    }

    pub fn shifted(self, by: [f64; 3], share: f64, top_nm: f64) -> Self {
        Self {
            compliance: (self.compliance + share * by[0]).max(0.1 * self.compliance),
            // Contacts that carried the largest amplitude have at least that Coulomb torque.
            coulomb_nm: (self.coulomb_nm + share * by[1]).max(1.001 * (top_nm + self.bias_nm.abs())),
            bias_nm: (self.bias_nm + share * by[2]).clamp(-0.2 * top_nm, 0.2 * top_nm),
        }
    }
}

/// Largest torque of all steps.
pub fn top_nm(all: &[&Swings]) -> f64 {
    all.iter().flat_map(|s| &s.torque_nm).fold(0.0, |top: f64, nm| top.max(nm.abs()))
}
