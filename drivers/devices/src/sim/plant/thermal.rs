//! Two thermal masses: the winding, and the gear with its housing.

use super::STEP_S;

const WINDING_J_PER_K: f64 = 60.0;
const GEAR_J_PER_K: f64 = 110.0;
const WINDING_TO_GEAR_W_PER_K: f64 = 0.8;
const GEAR_TO_AIR_W_PER_K: f64 = 0.45;
/// Phase resistance; the loss in three phases is 3/2 of i_q² (amplitude-invariant transformation).
const PHASE_OHM: f64 = 0.25;

pub struct Thermal {
    ambient_c: f64,
    winding_c: f64,
    gear_c: f64,
}

impl Thermal {
    pub fn new(ambient_c: f64) -> Self {
        Self { ambient_c, winding_c: ambient_c, gear_c: ambient_c }
    }

    pub fn gear_c(&self) -> f64 {
        self.gear_c
    }

    pub fn advance(&mut self, motor_current_a: f64, friction_w: f64) {
        let inward_w = WINDING_TO_GEAR_W_PER_K * (self.winding_c - self.gear_c);
        let copper_w = 1.5 * PHASE_OHM * motor_current_a * motor_current_a;
        let outward_w = GEAR_TO_AIR_W_PER_K * (self.gear_c - self.ambient_c);
        self.winding_c += (copper_w - inward_w) / WINDING_J_PER_K * STEP_S;
        self.gear_c += (friction_w.max(0.0) + inward_w - outward_w) / GEAR_J_PER_K * STEP_S;
    }
}
