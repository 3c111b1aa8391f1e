//! Noise as a function of seed, signal and time: the order of requests does not change the noise of other signals.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Signals with their own noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    Coulomb,
    Viscous,
    SensorDrift,
    MotorCurrent,
    BusVoltage,
    GearThermistor,
    StageThermistor,
    TorqueCoarse,
    TorqueFine,
    SupplyVoltage,
    SupplyCurrent,
    Hidden,
    SensorQuartz,
    EncoderStartup,
    EncoderPhase,
    Temperature,
    Stage,
    Multimeter,
    Stroke,
    Readout,
}

#[derive(Debug, Clone, Copy)]
pub struct Noise {
    seed: u64,
}

impl Noise {
    pub fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// Standard normal draw for a signal at a step.
    pub fn at(&self, signal: Signal, step: u64) -> f64 {
        StandardNormal.sample(&mut self.generator(signal, step))
    }

    /// A property of this specimen by its seed: uniform from −1 to 1, constant.
    pub fn trait_of(&self, signal: Signal) -> f64 {
        2.0 * (self.generator(signal, u64::MAX).next_u64() as f64 / u64::MAX as f64) - 1.0
    }

    pub fn generator(&self, signal: Signal, step: u64) -> ChaCha8Rng {
        // Odd multipliers keep the three numbers separate; the seeding of the generator mixes them.
        let mixed = self.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ step.wrapping_mul(0xD1B5_4A32_D192_ED03);
        ChaCha8Rng::seed_from_u64(mixed.wrapping_add((signal as u64).wrapping_mul(0x8CB9_2BA7_2F3D_8DD7)))
    }
}
