//! Hidden effects of a hysteresis brake: a rotor that differs from the data sheet.

use super::Figures;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Every brake has saturation and hysteresis; hidden, both are larger. Cogging and temperature are not included: runs
/// at link speeds do not show them in comparison with the hysteresis.
pub const EFFECTS: [&str; 3] = ["velocity_dependence", "hysteresis", "saturation"];

/// Eddy currents in a rotor that is too thick: increase per speed, and the speed of their maximum.
#[derive(Debug, Clone, Copy)]
struct Eddies {
    per_rad_s: f64,
    most_rad_s: f64,
}

#[derive(Debug, Clone, Copy, Default)]
pub struct HiddenBrake {
    eddies: Option<Eddies>,
    /// Width of the rotor's hysteresis, as a fraction of the rated current.
    pub width: Option<f64>,
    /// Current at which the iron around the coil saturates, as a fraction of the rated current.
    bend: Option<f64>,
}

impl HiddenBrake {
    /// Draws one of [`EFFECTS`].
    pub fn draw(&mut self, name: &str, draw: &mut ChaCha8Rng) {
        match name {
            "velocity_dependence" => {
                let (per_rad_s, most_rad_s) = (draw.random_range(0.03..0.06), draw.random_range(8.0..12.0));
                self.eddies = Some(Eddies { per_rad_s, most_rad_s });
            }
            "hysteresis" => self.width = Some(draw.random_range(0.18..0.3)),
            _ => self.bend = Some(draw.random_range(0.8..1.5)),
        }
    }

    /// Increase of the current's torque by eddy currents, as a fraction of it.
    pub fn eddy(&self, speed_rad_s: f64) -> f64 {
        let slowed =
            |eddies: Eddies| eddies.per_rad_s * speed_rad_s / (1.0 + (speed_rad_s / eddies.most_rad_s).powi(2));
        self.eddies.map_or(0.0, slowed)
    }

    /// The current that would produce the same field in air.
    pub fn field(&self, current: f64) -> f64 {
        self.bend.map_or(current, |bend| bend * (current / bend).atan())
    }

    pub fn figures(&self) -> [Option<Figures>; EFFECTS.len()] {
        let eddies = |eddies: Eddies| vec![("per_rad_s", eddies.per_rad_s), ("most_rad_s", eddies.most_rad_s)];
        [
            self.eddies.map(eddies),
            self.width.map(|width| vec![("width", width)]),
            self.bend.map(|bend| vec![("bend", bend)]),
        ]
    }
}
