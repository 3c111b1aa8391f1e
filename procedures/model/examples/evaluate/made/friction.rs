//! Friction runs: a staircase of speeds and loads, long turns, slow swings, in a closed velocity loop with quantised
//! encoders, filtered velocity, a delayed torque sensor, and coloured noise.

use super::joint::{Joint, Moment};
use super::{Coloured, Dice, rounded, table};
use jointbench_instrument::{Kind, Meta, RunTable};
use std::f64::consts::TAU;

pub const SINGLES: &[&str] = &[
    "stribeck",
    "direction_offset",
    "viscous_asymmetry",
    "viscous_quadratic",
    "viscous_sublinear",
    "load_linear",
    "load_quadratic",
    "load_viscous",
    "stribeck_load",
    "temperature_viscous",
    "temperature_coulomb",
    "gravity",
    "cogging",
    "friction_ripple",
    "drift",
    "torque_constant_saturation",
    "presliding",
];

pub const PAIRS: &[[&str; 2]] = &[
    ["stribeck", "load_linear"],
    ["load_linear", "temperature_viscous"],
    ["direction_offset", "stribeck"],
    ["gravity", "load_linear"],
    ["viscous_asymmetry", "stribeck"],
    ["temperature_coulomb", "friction_ripple"],
    ["load_quadratic", "viscous_quadratic"],
];

pub const UNKNOWN: &[&str] = &["bump", "hump"];

/// One step of the profile.
struct Step {
    speed: f64,
    load: f64,
    repeat: usize,
    lasts_s: f64,
    swings: bool,
}

const STEP_S: f64 = 0.004;
const SUBSTEPS: usize = 8;

pub fn make(dice: &mut Dice, hidden: &[&str]) -> RunTable {
    let mut joint = Joint::new(dice);
    let count = *dice.pick(&[9, 11, 12]);
    let slow = dice.uniform(0.015, 0.025);
    let speeds: Vec<f64> = (0..count).map(|i| joint.fastest * slow.powf(1.0 - i as f64 / (count - 1) as f64)).collect();
    hidden.iter().for_each(|h| joint.hide(h, &speeds, dice));
    record(&joint, &steps(&joint, &speeds, hidden, dice), dice)
}

fn steps(joint: &Joint, speeds: &[f64], hidden: &[&str], dice: &mut Dice) -> Vec<Step> {
    let turns = dice.coin() || hidden.iter().any(|h| ["gravity", "friction_ripple", "cogging", "bump"].contains(h));
    let swings = dice.coin() || hidden.contains(&"presliding");
    let lasts_s = dice.uniform(1.0, 1.3);
    let (mut steps, mut order) = (Vec::new(), speeds.to_vec());
    let mut both = |speed: f64, load, repeat, lasts_s, swings| {
        for speed in [speed, -speed] {
            steps.push(Step { speed, load, repeat, lasts_s, swings });
        }
    };
    for repeat in 0..2 {
        for load in [0.0, 0.35, 1.0] {
            dice.shuffle(&mut order);
            order.iter().for_each(|speed| both(*speed, load * joint.heaviest, repeat, lasts_s, false));
        }
    }
    for repeat in 0..2 {
        for share in [0.35, 0.8] {
            let speed = share * joint.fastest;
            if turns {
                both(speed, 0.0, repeat, 1.6 * TAU * joint.gear / speed, false);
            }
            if swings {
                both(share * 0.05 * joint.fastest, 0.0, repeat, 10.0, true);
            }
        }
    }
    steps
}

/// Drive, brake, sensors and surroundings of a joint.
struct Rig {
    acceleration: f64,
    reset: f64,
    gain: f64,
    /// Step of the motor's encoder [rad].
    count: f64,
    heating: f64,
    cooling_s: f64,
    noise: Coloured,
    scatter_nm: f64,
    sensor_noise: f64,
    filter_s: f64,
    sensor_s: f64,
    brake_s: f64,
}

impl Rig {
    fn new(joint: &Joint, steps: &[Step], dice: &mut Dice) -> Self {
        let bandwidth = dice.uniform(30.0, 60.0);
        let acceleration = joint.fastest / dice.uniform(0.08, 0.15);
        let count = TAU / f64::from(*dice.pick(&[4096u32, 8192, 16384]));
        let (heating, cooling_s) = (dice.uniform(20.0, 50.0), dice.uniform(50.0, 110.0));
        let noise_nm = dice.size(0.02, 0.08) * joint.dry.max(0.015);
        let noise = Coloured::new(noise_nm, dice.uniform(0.1, 0.5), dice.uniform(0.7, 0.95));
        let scatter_nm = noise_nm * dice.uniform(0.03, 0.15);
        let (filter_s, sensor_s, brake_s) =
            (dice.uniform(0.005, 0.015), dice.uniform(0.002, 0.01), dice.uniform(0.03, 0.06));
        // Tuned so that the slowest step breaks away within a tenth of a second.
        let slowest = steps.iter().map(|s| s.speed.abs()).fold(f64::INFINITY, f64::min);
        let reset =
            (joint.inertia * bandwidth * bandwidth / 4.0).max(2.0 * joint.dry / (slowest * dice.uniform(0.06, 0.12)));
        let gain = 1.6 * (reset * joint.inertia).sqrt();
        let sensor_noise = 1e-3 * joint.heaviest;
        Self {
            acceleration,
            reset,
            gain,
            count,
            heating,
            cooling_s,
            noise,
            scatter_nm,
            sensor_noise,
            filter_s,
            sensor_s,
            brake_s,
        }
    }
}

/// State of the joint, its drive and its sensors.
#[derive(Default)]
struct State {
    time: f64,
    q: f64,
    v: f64,
    bristle: f64,
    load: f64,
    warmth: f64,
    reference: f64,
    integral: f64,
    seen_q: f64,
    loop_v: f64,
    seen_v: f64,
    seen_load: f64,
}

impl State {
    /// The torque of the drive, which follows the velocity `wish`.
    fn drive(&mut self, rig: &Rig, wish: f64, dt: f64) -> f64 {
        self.reference += (wish - self.reference).clamp(-rig.acceleration * dt, rig.acceleration * dt);
        // The drive interpolates its encoder finer than it reports it.
        let counted = rounded(self.q, rig.count / 16.0);
        self.loop_v += ((counted - self.seen_q) / dt - self.loop_v) * dt / 0.002;
        self.seen_v += (self.loop_v - self.seen_v) * dt / rig.filter_s;
        self.seen_q = counted;
        self.integral += rig.reset * (self.reference - self.loop_v) * dt;
        rig.gain * (self.reference - self.loop_v) + self.integral
    }

    fn brake(&mut self, joint: &Joint, rig: &Rig, load: f64, dt: f64) {
        self.load += (load * (self.v / (0.005 * joint.fastest)).tanh() - self.load) * dt / rig.brake_s;
        self.seen_load += (self.load - self.seen_load) * dt / rig.sensor_s;
    }

    /// Motion under a torque. `grip` scales the bristles of this step.
    fn advance(&mut self, joint: &Joint, rig: &Rig, drive: f64, grip: f64, (last_s, dt): (f64, f64)) {
        let stiffness = joint.dry / joint.bristle;
        let damping = (stiffness * joint.inertia).sqrt();
        let at = Moment {
            velocity: self.v,
            load: self.load.abs() / joint.gear,
            motor: self.q,
            link: self.q / joint.gear,
            warmth: self.warmth,
            time: self.time,
        };
        let carries = joint.bristles(&at) * grip;
        let before = self.bristle;
        let end = carries * self.v.signum();
        self.bristle = end + (self.bristle - end) * (-stiffness * self.v.abs() * dt / carries).exp();
        let bending = damping * (self.bristle - before) / (dt * stiffness);
        let rest = drive - self.load / joint.gear - self.bristle - bending - joint.without_hysteresis(&at, last_s);
        // Implicit while the bristles stick, because their stiffness requires a shorter time step otherwise.
        let sticks = if self.bristle.abs() < 0.98 * carries { dt * (damping + stiffness * dt) } else { 0.0 };
        self.v += rest / (joint.inertia + sticks) * dt;
        self.q += self.v * dt;
        let heat = self.v.abs() / joint.fastest + 0.2 * self.load.abs() / joint.heaviest;
        self.warmth += (rig.heating * heat - self.warmth) * dt / rig.cooling_s;
        self.time += dt;
    }
}

const NAMES: [&str; 10] = [
    "time_s",
    "motor_position_rad",
    "motor_velocity_rad_s",
    "motor_current_a",
    "link_position_rad",
    "link_torque_nm",
    "temperature_c",
    "brake_torque_command_nm",
    "segment",
    "repeat",
];

fn record(joint: &Joint, steps: &[Step], dice: &mut Dice) -> RunTable {
    let dt = STEP_S / SUBSTEPS as f64;
    let last_s: f64 = steps.iter().map(|s| s.lasts_s).sum();
    let mut rig = Rig::new(joint, steps, dice);
    let mut state = State::default();
    let mut columns = vec![Vec::new(); NAMES.len()];
    for (number, step) in steps.iter().enumerate() {
        let (offset, grip) = (rig.scatter_nm * dice.normal(), 1.0 + rig.scatter_nm / joint.dry * dice.normal());
        let rows = (step.lasts_s / STEP_S) as usize;
        for row in 0..rows {
            let mut drive = 0.0;
            for _ in 0..SUBSTEPS {
                let into = row as f64 * STEP_S;
                let wish = if step.swings { step.speed * (TAU * 0.4 * into).sin() } else { step.speed };
                drive = state.drive(&rig, wish, dt);
                state.brake(joint, &rig, step.load, dt);
                state.advance(joint, &rig, drive, grip, (last_s, dt));
            }
            // Saturated iron gives less torque for each ampere, so that the drive needs more current.
            let largest = 2.0 * (joint.heaviest / joint.gear + joint.dry);
            let asked = drive * (1.0 + joint.iron * (2.0 * drive / largest).powi(2));
            let current = (asked + offset + rig.noise.next(dice)) / joint.torque_constant;
            let values = [
                state.time,
                rounded(state.q, rig.count),
                state.seen_v,
                current,
                rounded(state.q / joint.gear, TAU / 524_288.0),
                state.seen_load + rig.sensor_noise * dice.normal(),
                rounded(25.0 + state.warmth, 0.1),
                step.load,
                number as f64,
                step.repeat as f64,
            ];
            columns.iter_mut().zip(values).for_each(|(c, v)| c.push(v));
        }
    }
    let meta = Meta {
        kind: Some(Kind::Friction),
        torque_constant_nm_per_a: Some(joint.torque_constant),
        gear_ratio: Some(joint.gear),
        rotor_inertia_kg_m2: Some(joint.inertia),
        baseline: ["inertia", "load_transmission", "coulomb", "viscous"].map(String::from).into(),
        sample_rate_hz: Some(1.0 / STEP_S),
        ..Meta::default()
    };
    table(meta, NAMES.map(String::from).into(), columns)
}
