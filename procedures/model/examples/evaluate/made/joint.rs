//! A joint in a closed velocity loop: presliding bristles, oil, teeth, magnets, heat.

use super::Dice;

/// Quantities that the friction of a joint may depend on.
pub struct Moment {
    pub velocity: f64,
    /// Load on the motor side [Nm], absolute value.
    pub load: f64,
    pub motor: f64,
    pub link: f64,
    pub warmth: f64,
    pub time: f64,
}

/// A joint. Parameters are zero if an effect is not hidden.
#[derive(Clone, Default)]
pub struct Joint {
    pub torque_constant: f64,
    pub gear: f64,
    pub inertia: f64,
    pub dry: f64,
    pub oil: f64,
    pub fastest: f64,
    pub heaviest: f64,
    /// Presliding displacement [rad].
    pub bristle: f64,
    lubrication: f64,
    lubrication_speed: f64,
    hess_soom: bool,
    one_sided: f64,
    oil_one_sided: f64,
    windage: f64,
    thinning: f64,
    thinning_speed: f64,
    thinning_index: f64,
    mesh: f64,
    mesh_squared: f64,
    mesh_oil: f64,
    mesh_slow: f64,
    oil_warm: f64,
    dry_warm: f64,
    unbalance: f64,
    phase: f64,
    teeth: Vec<(f64, f64, f64)>,
    out_of_round: f64,
    lobes: f64,
    pub iron: f64,
    creeping_zero: f64,
    scratch: f64,
    scratch_width: f64,
    resonance: f64,
    resonance_speed: f64,
}

impl Joint {
    /// A joint without hidden effects.
    pub fn new(dice: &mut Dice) -> Self {
        let dry = dice.size(0.006, 0.05);
        let gear = *dice.pick(&[36.0, 50.0, 76.7, 100.0, 121.0, 177.8]);
        let fastest = dice.uniform(90.0, 220.0);
        Self {
            torque_constant: dice.size(0.03, 0.12),
            gear,
            inertia: dice.size(8e-6, 6e-5),
            dry,
            oil: dry * dice.uniform(0.3, 1.3) / fastest,
            fastest,
            heaviest: gear * dry * dice.uniform(2.5, 9.0),
            bristle: dice.size(4e-5, 2e-4),
            ..Self::default()
        }
    }

    pub fn hide(&mut self, effect: &str, speeds: &[f64], dice: &mut Dice) {
        let (dry, oil, fastest) = (self.dry, self.oil, self.fastest);
        let heavy = self.heaviest / self.gear;
        match effect {
            "stribeck" => {
                self.lubrication = dry * dice.uniform(0.2, 0.6);
                self.lubrication_speed = fastest * dice.size(0.03, 0.08);
                self.hess_soom = dice.coin();
            }
            "direction_offset" => self.one_sided = dry * dice.uniform(0.05, 0.25) * dice.sign(),
            "viscous_asymmetry" => self.oil_one_sided = dice.uniform(0.08, 0.3) * dice.sign(),
            "viscous_quadratic" => self.windage = oil * dice.uniform(0.3, 0.9) / fastest,
            "viscous_sublinear" => {
                self.thinning = dry * dice.uniform(0.4, 1.0);
                self.thinning_speed = fastest * dice.size(0.01, 0.03);
                self.thinning_index = dice.uniform(0.3, 0.6);
            }
            "load_linear" => self.mesh = dice.uniform(0.03, 0.15),
            "load_quadratic" => self.mesh_squared = dice.uniform(0.04, 0.15) / heavy,
            "load_viscous" => self.mesh_oil = dice.uniform(0.03, 0.12) / fastest,
            "stribeck_load" => {
                self.mesh_slow = dice.uniform(0.06, 0.15);
                self.lubrication_speed = fastest * dice.size(0.04, 0.08);
            }
            "temperature_viscous" => self.oil_warm = dice.uniform(0.006, 0.018),
            "temperature_coulomb" => self.dry_warm = dice.uniform(0.003, 0.01),
            "gravity" => {
                self.unbalance = dry * dice.uniform(0.15, 0.6);
                self.phase = dice.phase();
            }
            "cogging" => {
                let first = *dice.pick(&[4.0, 6.0, 8.0, 12.0, 14.0, 24.0]);
                self.teeth = vec![(first, dry * dice.uniform(0.1, 0.4), dice.phase())];
            }
            "friction_ripple" => {
                self.out_of_round = dice.uniform(0.1, 0.35);
                self.lobes = *dice.pick(&[1.0, 2.0, 3.0, 4.0, 6.0]);
                self.phase = dice.phase();
            }
            "torque_constant_saturation" => self.iron = dice.uniform(0.05, 0.15),
            "drift" => self.creeping_zero = dry * dice.uniform(0.15, 0.5) * dice.sign(),
            "presliding" => self.bristle = dice.size(0.15, 1.2),
            "bump" => {
                self.scratch = dice.uniform(0.6, 1.5);
                self.scratch_width = dice.uniform(0.05, 0.14);
                self.phase = dice.phase();
            }
            "hump" => {
                self.resonance = dice.uniform(0.3, 0.7);
                self.resonance_speed = *dice.pick(&speeds[speeds.len() / 3..speeds.len() - 2]);
            }
            _ => panic!("{effect} has no arm here"),
        }
    }

    /// Slip torque of the bristles [Nm].
    pub fn bristles(&self, m: &Moment) -> f64 {
        let w = m.velocity.abs();
        let x = w / self.lubrication_speed.max(1e-9);
        let film = if self.hess_soom { 1.0 / (1.0 + x * x) } else { 1.0 / x.min(300.0).cosh() };
        let round = 1.0 + self.out_of_round * (self.lobes * m.link + self.phase).cos();
        let away = (m.link - self.phase).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        let scratch = self.scratch * (-0.5 * (away / self.scratch_width.max(1e-9)).powi(2)).exp();
        let shake = 1.0 - w / self.resonance_speed.max(1e-9);
        let resonance = self.resonance * (-0.5 * (shake / 0.12).powi(2)).exp();
        let warm = 1.0 - self.dry_warm * m.warmth;
        let thinning = self.thinning
            * (w / self.fastest)
            * (1.0 + (w / self.thinning_speed.max(1e-9)).powi(2)).powf(0.5 * (self.thinning_index - 1.0))
            * (self.fastest / self.thinning_speed.max(1e-9)).powf(1.0 - self.thinning_index);
        let loaded = m.load * (self.mesh + self.mesh_squared * m.load + self.mesh_slow * film);
        self.dry * (round * warm + scratch + resonance) + self.lubrication * film + thinning + loaded
    }

    /// Torque without hysteresis [Nm].
    pub fn without_hysteresis(&self, m: &Moment, last_s: f64) -> f64 {
        let side = 1.0 + 0.5 * self.oil_one_sided * m.velocity.signum();
        let oil = self.oil * side * (-self.oil_warm * m.warmth).exp() + self.windage * m.velocity.abs();
        let magnets: f64 = self.teeth.iter().map(|(h, a, p)| a * (h * m.motor + p).cos()).sum();
        (oil + self.mesh_oil * m.load) * m.velocity
            + self.unbalance * (m.link + self.phase).cos()
            + self.one_sided
            + self.creeping_zero * m.time / last_s
            + magnets
    }
}
