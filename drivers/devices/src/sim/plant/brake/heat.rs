//! Heat of a hysteresis brake: the rotor, where the heat is generated, inside the housing with the coil.

use super::super::{AMBIENT_C, STEP_S};

/// The values of the housing reproduce both ratings: 75 K at 350 W, and in 300 s at 1200 W.
const HOUSING_K_PER_W: f64 = 0.214;
const HOUSING_J_PER_K: f64 = 2350.0;
/// Time constant of the rotor: 80 s (assumed: 60 to 120 s).
const ROTOR_K_PER_W: f64 = 0.08;
const ROTOR_J_PER_K: f64 = 1000.0;

pub struct Heat {
    pub rotor_c: f64,
    pub housing_c: f64,
}

impl Heat {
    pub fn new() -> Self {
        Self { rotor_c: AMBIENT_C, housing_c: AMBIENT_C }
    }

    pub fn advance(&mut self, friction_w: f64, coil_w: f64) {
        let inward_w = (self.rotor_c - self.housing_c) / ROTOR_K_PER_W;
        let lost_w = (self.housing_c - AMBIENT_C) / HOUSING_K_PER_W;
        self.rotor_c += (friction_w - inward_w) / ROTOR_J_PER_K * STEP_S;
        self.housing_c += (inward_w + coil_w - lost_w) / HOUSING_J_PER_K * STEP_S;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn risen_k(power_w: f64, seconds: f64) -> f64 {
        let mut heat = Heat::new();
        for _ in 0..(seconds / STEP_S) as usize {
            heat.advance(power_w, 0.0);
        }
        heat.housing_c - AMBIENT_C
    }

    #[test]
    fn both_ratings_of_the_data_sheet_lead_to_a_housing_of_100_degrees() {
        assert!((risen_k(350.0, 6000.0) - 75.0).abs() < 2.0, "{}", risen_k(350.0, 6000.0));
        assert!((risen_k(1200.0, 300.0) - 75.0).abs() < 4.0, "{}", risen_k(1200.0, 300.0));
    }
}
