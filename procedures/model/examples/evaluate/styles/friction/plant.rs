//! A motor and a link with a flexible gear between them, in a closed loop, on the motor side.

use super::bristle::Bristle;
use super::laws::{Law, Moment};
use crate::made::{Dice, rounded};
use std::f64::consts::TAU;

/// Mechanics. Everything on the motor side.
pub struct Plant {
    pub gear: f64,
    pub inertia: f64,
    pub link_inertia: f64,
    pub stiffness: f64,
    pub damping: f64,
    pub dry: f64,
    pub oil: f64,
    pub bristle: Bristle,
    /// Presliding displacement [rad], and damping of the bristles [Nm·s].
    pub bend: f64,
    pub bristle_damping: f64,
    /// Gravity torque of an arm on the link [Nm].
    pub arm: f64,
    pub brake: f64,
    pub fastest: f64,
    /// Laws that act on the motion of the joint.
    pub laws: Vec<Law>,
    pub state: State,
}

#[derive(Default)]
pub struct State {
    pub motor: f64,
    pub velocity: f64,
    pub link: f64,
    pub link_velocity: f64,
    pub sticks: f64,
}

impl Plant {
    /// One step under a motor torque and a share of the brake. `at` contains the quantities of the laws.
    pub fn step(&mut self, torque: f64, brake: f64, at: &mut Moment, dt: f64) {
        let s = &mut self.state;
        at.load = self.stiffness * (s.motor - s.link) + self.damping * (s.velocity - s.link_velocity);
        let sticks = self.bristle.after(s.velocity * dt / self.bend);
        at.dry = self.dry * sticks + self.bristle_damping * (sticks - s.sticks) / dt;
        s.sticks = sticks;
        (at.time, at.velocity, at.bristle, at.torque) = (at.time + dt, s.velocity, sticks, torque);
        (at.motor, at.link) = (s.motor, s.link / self.gear);
        let laws: f64 = self.laws.iter().map(|law| law(at)).sum();
        at.acceleration = (torque - at.load - at.dry - self.oil * s.velocity - laws) / self.inertia;
        s.velocity += at.acceleration * dt;
        s.motor += s.velocity * dt;
        // The brake is integrated implicitly, because its slope is too steep for the time step.
        let slow = 0.02 * self.fastest;
        let grips = (s.link_velocity / slow).tanh();
        let slope = brake * self.brake / slow * (1.0 - grips * grips);
        let rest = at.load - brake * self.brake * grips - self.arm * (s.link / self.gear).sin();
        s.link_velocity += rest * dt / (self.link_inertia + slope * dt);
        s.link += s.link_velocity * dt;
    }
}

/// Position and velocity control on a quantised encoder, with a current loop that has a lag.
pub struct Drive {
    pub count: f64,
    bandwidth: f64,
    gain: f64,
    observed: Observer,
    wanted: f64,
    integral: f64,
    torque: f64,
    lag_s: f64,
}

impl Drive {
    pub fn new(plant: &Plant, bits: u32, dice: &mut Dice) -> Self {
        let inertia = plant.inertia + plant.link_inertia;
        let free = 1.0 / plant.inertia + 1.0 / plant.link_inertia;
        let resonance = (plant.stiffness * free).sqrt();
        let bandwidth = dice.uniform(40.0, 90.0).min(resonance / 6.0);
        Self {
            count: TAU / f64::from(1u32 << bits),
            bandwidth,
            gain: inertia * bandwidth,
            observed: Observer::new(dice.uniform(400.0, 800.0), plant.state.motor),
            wanted: plant.state.motor,
            integral: 0.0,
            torque: 0.0,
            lag_s: dice.uniform(2e-4, 8e-4),
        }
    }

    pub fn reading(&self, motor: f64) -> f64 {
        rounded(motor, self.count)
    }

    /// The motor torque for a velocity set-point.
    pub fn torque(&mut self, wanted: f64, motor: f64, dt: f64) -> f64 {
        self.wanted += wanted * dt;
        self.observed.follow(rounded(motor, self.count / 16.0), dt);
        let error = wanted + 0.25 * self.bandwidth * (self.wanted - self.observed.angle) - self.observed.velocity;
        self.integral += 0.35 * self.bandwidth * self.gain * error * dt;
        let asked = self.gain * error + self.integral;
        self.torque += (asked - self.torque) * (dt / self.lag_s).min(1.0);
        self.torque
    }
}

/// A tracking loop of second order: the velocity that a drive reports.
pub struct Observer {
    pub angle: f64,
    pub velocity: f64,
    pub bandwidth: f64,
}

impl Observer {
    pub fn new(bandwidth: f64, angle: f64) -> Self {
        Self { angle, velocity: 0.0, bandwidth }
    }

    pub fn follow(&mut self, reading: f64, dt: f64) {
        let error = reading - self.angle;
        self.angle += (self.velocity + 1.6 * self.bandwidth * error) * dt;
        self.velocity += self.bandwidth * self.bandwidth * error * dt;
    }
}
