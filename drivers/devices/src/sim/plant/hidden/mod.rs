//! Hidden effects of a mock bench: each effect by name, its size drawn from the seed. One file per part of the bench.

mod brake;
mod encoder;
mod friction;
mod gear;

pub use brake::HiddenBrake;
pub use encoder::HiddenEncoder;
pub use friction::HiddenFriction;
pub use gear::{Contact, HiddenGear};

use super::{Noise, Signal};
use crate::sim::data_sheet::{DataSheet, Joint};
use jointbench_instrument::Kind;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Effects that can be hidden, by the kind of run that shows them. Without a hidden effect, friction is only Coulomb
/// and viscous, and gear, brake and encoders match their data sheets.
pub const HIDDEN_EFFECTS: [(Kind, &[&str]); 4] = [
    (Kind::Friction, &friction::EFFECTS),
    (Kind::Encoder, &encoder::EFFECTS),
    (Kind::Stiffness, &gear::EFFECTS),
    (Kind::Brake, &brake::EFFECTS),
];

/// One hidden effect with its true parameters; the names contain the units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HiddenEffect {
    /// Name of the effect, from [`HIDDEN_EFFECTS`].
    pub effect: String,
    /// True value of each parameter; the unit is the suffix of its name.
    pub parameters: BTreeMap<String, f64>,
}

/// Parameters of an effect with their names.
type Figures = Vec<(&'static str, f64)>;

#[derive(Debug, Clone, Copy)]
struct Wave {
    size: f64,
    harmonic: f64,
    phase_rad: f64,
}

impl Wave {
    fn draw(size: f64, harmonics: [u8; 2], draw: &mut ChaCha8Rng) -> Self {
        let harmonic = f64::from(draw.random_range(harmonics[0]..=harmonics[1]));
        Self { size, harmonic, phase_rad: draw.random_range(0.0..TAU) }
    }

    fn at(self, angle_rad: f64) -> f64 {
        self.size * (self.harmonic * angle_rad + self.phase_rad).sin()
    }

    fn figures(self, unit: &'static str) -> Figures {
        vec![(unit, self.size), ("harmonic", self.harmonic), ("phase_rad", self.phase_rad)]
    }
}

impl Joint {
    /// Whether the mock bench of this joint has the instruments for this kind of run.
    fn shows(self, kind: Kind) -> bool {
        match kind {
            Kind::Friction => true,
            Kind::Encoder => self == Joint::EncoderShaft,
            Kind::Stiffness | Kind::Brake => matches!(self, Joint::JointA | Joint::JointB),
        }
    }

    /// Effects that the mock bench of this joint can hide.
    pub fn hides(self) -> Vec<&'static str> {
        let shown = HIDDEN_EFFECTS.iter().filter(|(kind, _)| self.shows(*kind));
        shown.flat_map(|(_, effects)| effects.iter().copied()).collect()
    }
}

#[derive(Debug, Clone, Copy, Default)]
pub struct Hidden {
    pub friction: HiddenFriction,
    pub encoder: HiddenEncoder,
    pub gear: HiddenGear,
    pub brake: HiddenBrake,
}

impl Hidden {
    /// Draws the named effects. `Err` contains a name that the bench of this joint cannot hide.
    pub fn draw(sheet: impl Into<DataSheet>, seed: u64, effects: &[String]) -> Result<Self, String> {
        let sheet: DataSheet = sheet.into();
        let mut hidden = Self { friction: HiddenFriction::of(&sheet), ..Self::default() };
        for name in effects {
            let shown = HIDDEN_EFFECTS.iter().enumerate().filter(|(_, (kind, _))| sheet.joint.shows(*kind));
            let mut found = shown.filter_map(|(of, (kind, effects))| {
                let at = effects.iter().position(|effect| effect == name)?;
                Some((*kind, effects[at], (of << 8 | at) as u64))
            });
            let Some((kind, name, number)) = found.next() else { return Err(name.clone()) };
            let draw = &mut Noise::new(seed).generator(Signal::Hidden, number);
            match kind {
                Kind::Friction => hidden.friction.draw(name, &sheet, draw),
                Kind::Encoder => hidden.encoder.draw(name, draw),
                Kind::Stiffness => hidden.gear.draw(name, &sheet, draw),
                Kind::Brake => hidden.brake.draw(name, draw),
            }
        }
        Ok(hidden)
    }

    pub fn described(&self) -> Vec<HiddenEffect> {
        let figures = [
            self.friction.figures().to_vec(),
            self.encoder.figures().to_vec(),
            self.gear.figures().to_vec(),
            self.brake.figures().to_vec(),
        ];
        let names = HIDDEN_EFFECTS.iter().flat_map(|(_, effects)| effects.iter());
        let drawn = names.zip(figures.into_iter().flatten());
        let described = drawn.filter_map(|(effect, figures)| {
            let parameters = figures?.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
            Some(HiddenEffect { effect: (*effect).to_owned(), parameters })
        });
        described.collect()
    }
}
