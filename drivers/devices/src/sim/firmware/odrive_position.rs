//! A position loop without feed-forward that follows the integral of the velocity set-point. The firmware of the maker
//! has none: it represents the controllers of the joints in docs/documents.md.

use crate::sim::plant::STEP_S;

pub struct PositionLoop {
    gain_per_s: f64,
    /// Set-point of the position [turns]. `None`: it starts at the present position.
    set_point: Option<f64>,
}

impl PositionLoop {
    pub fn new(gain_per_s: f64) -> Self {
        Self { gain_per_s, set_point: None }
    }

    pub fn rest(&mut self) {
        self.set_point = None;
    }

    /// Velocity command after one step [turns/s].
    pub fn advance(&mut self, velocity_turns_s: f32, turns: f64) -> f32 {
        let set_point = self.set_point.unwrap_or(turns) + STEP_S * f64::from(velocity_turns_s);
        self.set_point = Some(set_point);
        (self.gain_per_s * (set_point - turns)) as f32
    }
}
