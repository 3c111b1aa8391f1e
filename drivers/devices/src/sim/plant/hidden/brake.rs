//! What a hysteresis brake hides: a rotor that is not that of the data sheet.

use super::Figures;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Every brake saturates and has a loop; hidden, both are larger. Cogging and temperature are not here: no run at the
/// link's speeds shows them beside the loop.
pub const EFFECTS: [&str; 3] = ["velocity_dependence", "hysteresis", "saturation"];

/// Eddy currents in a rotor that is too thick: what each of speed adds, and where they are strongest.
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
    /// Where the iron around the coil bends its field, as a fraction of the rated current.
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

    /// What eddy currents add to the torque of the current, as a share of it.
    pub fn eddy(&self, speed_rad_s: f64) -> f64 {
        let slowed =
            |eddies: Eddies| eddies.per_rad_s * speed_rad_s / (1.0 + (speed_rad_s / eddies.most_rad_s).powi(2));
        self.eddies.map_or(0.0, slowed)
    }

    /// The current that would make the same field in air.
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
