//! Hidden effects of a gear, in addition to the stiffness of its data sheet.

use super::{Figures, Wave};
use crate::sim::data_sheet::{DataSheet, brake};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// No backlash: the brake torque reverses with the joint, so a gap is confounded with a directional offset.
pub const EFFECTS: [&str; 4] = ["hardening", "torsional_hysteresis", "transmission_error", "creep"];

/// Friction contact between teeth: its holding torque, and its deflection before it slips.
#[derive(Debug, Clone, Copy)]
pub struct Contact {
    pub holds_nm: f64,
    pub bends_rad: f64,
}

/// Creep of plastic under load: fraction of the elastic twist, and time constant.
#[derive(Debug, Clone, Copy)]
pub struct Yielding {
    pub share: f64,
    pub lag_s: f64,
}

#[derive(Debug, Clone, Copy, Default)]
pub struct HiddenGear {
    /// The twist at which the stiffness of the gear is doubled.
    progressive_rad: Option<f64>,
    pub contact: Option<Contact>,
    pitch_rad: Option<Wave>,
    pub yielding: Option<Yielding>,
}

impl HiddenGear {
    /// Draws one of [`EFFECTS`]. Sizes are relative to the twist at the brake's rated torque.
    pub fn draw(&mut self, name: &str, sheet: &DataSheet, draw: &mut ChaCha8Rng) {
        let twist_rad = brake::RATED_TORQUE_NM / sheet.stiffness_nm_rad;
        match name {
            "hardening" => self.progressive_rad = Some(twist_rad / draw.random_range(0.3f64..0.6).sqrt()),
            "torsional_hysteresis" => {
                let holds_nm = brake::RATED_TORQUE_NM * draw.random_range(0.05..0.12);
                self.contact = Some(Contact { holds_nm, bends_rad: twist_rad * draw.random_range(0.2..0.5) });
            }
            "transmission_error" => {
                self.pitch_rad = Some(Wave::draw(twist_rad * draw.random_range(0.05..0.15), [8, 40], draw));
            }
            _ => {
                self.yielding =
                    Some(Yielding { share: draw.random_range(0.1..0.25), lag_s: draw.random_range(0.2..0.6) });
            }
        }
    }

    /// Stiffness of the gear at this twist, relative to that without twist.
    pub fn stiffening(&self, twist_rad: f64) -> f64 {
        self.progressive_rad.map_or(1.0, |scale_rad| 1.0 + (twist_rad / scale_rad).powi(2))
    }

    /// Deviation of the output position: each tooth has its own pitch.
    pub fn pitch_rad(&self, link_rad: f64) -> f64 {
        self.pitch_rad.map_or(0.0, |wave| wave.at(link_rad))
    }

    pub fn figures(&self) -> [Option<Figures>; EFFECTS.len()] {
        [
            self.progressive_rad.map(|scale_rad| vec![("twice_as_stiff_rad", scale_rad)]),
            self.contact.map(|contact| vec![("holds_nm", contact.holds_nm), ("bends_rad", contact.bends_rad)]),
            self.pitch_rad.map(|wave| wave.figures("rad")),
            self.yielding.map(|yielding| vec![("of_twist", yielding.share), ("lag_s", yielding.lag_s)]),
        ]
    }
}
