//! A simulated bench: torque over a staircase of speeds and loads, with formulas that the library does not contain.

use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// Conditions of one sample, which determine its torque.
#[derive(Clone, Copy)]
pub struct Moment {
    pub velocity: f64,
    pub load: f64,
    pub link: f64,
    pub time: f64,
}

pub struct Staircase {
    pub noise_nm: f64,
    /// Offset of each segment, the same for all its samples.
    pub scatter_nm: f64,
    pub seed: u64,
}

pub const GEAR: f64 = 50.0;
pub const TORQUE_CONSTANT: f64 = 0.08;

impl Staircase {
    /// Two repeats of ten speeds in both directions at three loads, 0.6 s each at 250 Hz.
    pub fn run(&self, friction: impl Fn(Moment) -> f64) -> RunTable {
        self.run_at(&[0.0, 4.0, 12.0], friction)
    }

    /// The same at other loads.
    pub fn run_at(&self, loads: &[f64], friction: impl Fn(Moment) -> f64) -> RunTable {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let noise = Normal::new(0.0, self.noise_nm).unwrap();
        let scatter = Normal::new(0.0, self.scatter_nm).unwrap();
        let names = [
            "time_s",
            "motor_position_rad",
            "motor_velocity_rad_s",
            "motor_current_a",
            "link_position_rad",
            "link_torque_nm",
            "segment",
            "repeat",
        ];
        let mut trace = Trace::new(names.iter().map(|n| Channel::new(*n)).collect());
        let (mut time, mut position, mut segment) = (0.0, 0.0, 0.0);
        for repeat in 0..2 {
            for &load in loads {
                for step in 0..10 {
                    for sign in [1.0, -1.0] {
                        let velocity = sign * 2.5 * 1.52f64.powi(step);
                        let offset = scatter.sample(&mut random);
                        for _ in 0..150 {
                            time += 0.004;
                            position += velocity * 0.004;
                            let moment = Moment { velocity, load: sign * load, link: position / GEAR, time };
                            let torque = friction(moment) + moment.load / GEAR + offset + noise.sample(&mut random);
                            trace.push_row(&[
                                time,
                                position,
                                velocity,
                                torque / TORQUE_CONSTANT,
                                moment.link,
                                moment.load,
                                segment,
                                f64::from(repeat),
                            ]);
                        }
                        segment += 1.0;
                    }
                }
            }
        }
        RunTable::new(meta(), trace).unwrap()
    }
}

pub fn meta() -> Meta {
    Meta {
        kind: Some(Kind::Friction),
        torque_constant_nm_per_a: Some(TORQUE_CONSTANT),
        gear_ratio: Some(GEAR),
        baseline: ["load_transmission", "coulomb", "viscous"].map(String::from).into(),
        ..Meta::default()
    }
}
