//! Hidden effects of the magnetic ring of encoder S2, in addition to the error of its data sheet.

use super::{Figures, Wave};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// No temperature drift: the unloaded shaft stays at room temperature.
pub const EFFECTS: [&str; 2] = ["harmonic_n", "slip"];

/// A loose ring: it slips once after `after_turns` of rotation in either direction.
#[derive(Debug, Clone, Copy)]
struct Loose {
    points: f64,
    after_turns: f64,
}

#[derive(Debug, Clone, Copy, Default)]
pub struct HiddenEncoder {
    /// Deformation of the ring by its screws.
    lobes: Option<Wave>,
    loose: Option<Loose>,
}

impl HiddenEncoder {
    /// Draws one of [`EFFECTS`].
    pub fn draw(&mut self, name: &str, draw: &mut ChaCha8Rng) {
        match name {
            "harmonic_n" => {
                let points = draw.random_range(25.0..80.0);
                self.lobes = Some(Wave::draw(points, [3, 12], draw));
            }
            _ => {
                let points = draw.random_range(40.0..150.0);
                let points = if draw.random() { points } else { -points };
                self.loose = Some(Loose { points, after_turns: draw.random_range(10.0..50.0) });
            }
        }
    }

    /// Slip of the ring on the shaft.
    pub fn slipped_points(&self, travelled_rad: f64) -> f64 {
        self.loose.filter(|loose| travelled_rad > loose.after_turns * TAU).map_or(0.0, |loose| loose.points)
    }

    pub fn error_points(&self, angle_rad: f64) -> f64 {
        self.lobes.map_or(0.0, |lobes| lobes.at(angle_rad))
    }

    pub fn figures(&self) -> [Option<Figures>; EFFECTS.len()] {
        [
            self.lobes.map(|wave| wave.figures("points")),
            self.loose.map(|loose| vec![("points", loose.points), ("after_turns", loose.after_turns)]),
        ]
    }
}
