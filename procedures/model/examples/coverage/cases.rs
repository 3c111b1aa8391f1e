//! Simulated runs of all four kinds with known truth.

use super::noise::Noise;
use jointbench_instrument::{Channel, Kind, Meta, RunTable, TableFault, Trace};
use std::f64::consts::TAU;

/// One simulated bench with its hidden truth.
pub struct Case {
    pub name: &'static str,
    pub effects: &'static [&'static str],
    /// Effect, parameter, value.
    pub truth: &'static [(&'static str, &'static str, f64)],
    /// The true form of an effect that has several forms.
    pub forms: &'static [(&'static str, &'static str)],
    /// Nonlinear parameters of the model.
    pub curved: &'static [&'static str],
    pub run: fn(u64) -> Result<RunTable, TableFault>,
}

pub const CASES: [Case; 10] = [
    Case {
        name: "friction, stribeck",
        effects: &["load_transmission", "coulomb", "viscous", "stribeck", "direction_offset"],
        truth: &[
            ("coulomb", "tau_c", 0.03),
            ("viscous", "c_v", 1.5e-4),
            ("stribeck", "tau_s", 0.012),
            ("stribeck", "omega_s", 6.0),
            ("stribeck", "delta", 1.5),
            ("direction_offset", "tau_0", 0.002),
        ],
        forms: &[],
        curved: &["omega_s", "delta"],
        run: |seed| {
            staircase(seed, |w, _, _| {
                0.03 * w.signum() + 1.5e-4 * w + 0.012 * w.signum() * (-(w.abs() / 6.0).powf(1.5)).exp() + 0.002
            })
        },
    },
    Case {
        name: "friction, load and shear thinning",
        effects: &["load_transmission", "coulomb", "viscous_sublinear", "load_linear"],
        truth: &[
            ("coulomb", "tau_c", 0.03),
            ("viscous_sublinear", "c_alpha", 4e-3),
            ("viscous_sublinear", "alpha", 0.5),
            ("load_linear", "mu", 0.08),
        ],
        forms: &[],
        curved: &["alpha"],
        run: |seed| staircase(seed, |w, l, _| (0.03 + 0.08 * l.abs() + 4e-3 * w.abs().sqrt()) * w.signum()),
    },
    Case {
        name: "friction, gravity and drag",
        effects: &["load_transmission", "coulomb", "viscous", "viscous_quadratic", "gravity"],
        truth: &[
            ("coulomb", "tau_c", 0.03),
            ("viscous", "c_v", 1.5e-4),
            ("viscous_quadratic", "c_2", 2e-6),
            ("gravity", "g_c", 0.004),
            ("gravity", "g_s", -0.003),
        ],
        forms: &[("viscous_quadratic", "linear")],
        curved: &[],
        run: |seed| {
            staircase(seed, |w, _, q| {
                0.03 * w.signum() + 1.5e-4 * w + 2e-6 * w * w.abs() + 0.004 * q.cos() - 0.003 * q.sin()
            })
        },
    },
    Case {
        name: "friction, trajectory",
        effects: &["inertia", "coulomb", "viscous", "direction_offset", "viscous_asymmetry"],
        truth: &[
            ("inertia", "j", 2e-4),
            ("coulomb", "tau_c", 0.03),
            ("viscous", "c_v", 1.5e-3),
            ("direction_offset", "tau_0", 0.004),
            ("viscous_asymmetry", "c_a", 3e-4),
        ],
        forms: &[],
        curved: &[],
        run: trajectory,
    },
    Case {
        name: "encoder, eccentric and late",
        effects: &["offset", "delay", "harmonic_1"],
        truth: &[
            ("offset", "xi", 0.02),
            ("delay", "t_d", 4e-4),
            ("harmonic_1", "a", 1.5e-3),
            ("harmonic_1", "b", -8e-4),
        ],
        forms: &[],
        curved: &[],
        run: |seed| turns(seed, |q, w, _| 0.02 - 4e-4 * w + 1.5e-3 * q.cos() - 8e-4 * q.sin()),
    },
    Case {
        name: "encoder, slip",
        effects: &["offset", "delay", "slip"],
        truth: &[("offset", "xi", 0.02), ("delay", "t_d", 4e-4), ("slip", "s", 2e-3), ("slip", "t_s", 15.3)],
        forms: &[],
        curved: &["t_s"],
        run: |seed| turns(seed, |_, w, t| 0.02 - 4e-4 * w + if t > 15.3 { 2e-3 } else { 0.0 }),
    },
    Case {
        name: "stiffness, hardening",
        effects: &["offset", "compliance", "hardening"],
        truth: &[
            ("offset", "xi", 1e-3),
            ("compliance", "inverse_k", 1e-4),
            ("hardening", "phi_h", 8e-4),
            ("hardening", "tau_h", 5.0),
        ],
        forms: &[("hardening", "root")],
        curved: &["tau_h"],
        run: |seed| sweeps(seed, |t, _| 1e-3 + 1e-4 * t + 8e-4 * ((1.0 + t.abs() / 5.0).sqrt() - 1.0) * t.signum()),
    },
    Case {
        name: "stiffness, hysteresis",
        effects: &["offset", "compliance", "torsional_hysteresis"],
        truth: &[
            ("offset", "xi", 1e-3),
            ("compliance", "inverse_k", 1e-4),
            ("torsional_hysteresis", "eta", 6e-4),
            ("torsional_hysteresis", "tau_eta", 4.0),
        ],
        forms: &[("torsional_hysteresis", "dahl")],
        curved: &["tau_eta"],
        run: |seed| sweeps(seed, |t, z| 1e-3 + 1e-4 * t + 6e-4 * z),
    },
    Case {
        name: "brake, saturation",
        effects: &["drag", "torque_per_current", "saturation"],
        truth: &[
            ("drag", "tau_0", 0.02),
            ("torque_per_current", "k_b", 0.5),
            ("saturation", "c", 0.6),
            ("saturation", "i_s", 0.35),
        ],
        forms: &[("saturation", "tanh")],
        curved: &["i_s"],
        run: |seed| ramps(seed, |i, _, _| 0.02 + 0.5 * i + 0.6 * (i / 0.35).tanh()),
    },
    Case {
        name: "brake, speed",
        effects: &["drag", "torque_per_current", "velocity_dependence"],
        truth: &[("drag", "tau_0", 0.02), ("torque_per_current", "k_b", 0.5), ("velocity_dependence", "c_v", 1.2e-3)],
        forms: &[("velocity_dependence", "plain")],
        curved: &[],
        run: |seed| ramps(seed, |i, w, _| 0.02 + 0.5 * i + 1.2e-3 * w),
    },
];

fn meta(kind: Kind) -> Meta {
    Meta {
        kind: Some(kind),
        torque_constant_nm_per_a: Some(0.08),
        gear_ratio: Some(50.0),
        baseline: vec!["offset".into()],
        ..Meta::default()
    }
}

fn trace(names: &[&str]) -> Trace {
    Trace::new(names.iter().map(|n| Channel::new(*n)).collect())
}

/// Two repeats of ten speeds in both directions at three loads, 0.6 s each. `friction(velocity, load on the motor
/// side, link)`.
fn staircase(seed: u64, friction: fn(f64, f64, f64) -> f64) -> Result<RunTable, TableFault> {
    let mut noise = Noise::new(seed, 2e-3, 6e-4);
    let mut table = trace(&[
        "time_s",
        "motor_position_rad",
        "motor_velocity_rad_s",
        "motor_current_a",
        "link_position_rad",
        "link_torque_nm",
        "segment",
        "repeat",
    ]);
    let (mut time, mut position, mut segment) = (0.0, 0.0, 0.0);
    for repeat in [0.0, 1.0] {
        for load in [0.0, 4.0, 12.0] {
            for step in 0..20 {
                let sign = if step % 2 == 0 { 1.0 } else { -1.0 };
                let (velocity, load) = (sign * 2.5 * 1.52f64.powi(step / 2), sign * load);
                noise.segment();
                for i in 0..150 {
                    time += 0.004;
                    position += velocity * 0.004;
                    let link = position / 50.0;
                    let place = f64::from(i) / 74.5 - 1.0;
                    let torque = load / 50.0 + friction(velocity, load / 50.0, link) + noise.next(place, sign);
                    table.push_row(&[time, position, velocity, torque / 0.08, link, load, segment, repeat]);
                }
                segment += 1.0;
            }
        }
    }
    RunTable::new(meta(Kind::Friction), table)
}

/// Thirty strokes of different speed, back and forth, without a segment column.
fn trajectory(seed: u64) -> Result<RunTable, TableFault> {
    let mut noise = Noise::new(seed, 4e-3, 1.5e-3);
    let mut table = trace(&["time_s", "motor_position_rad", "motor_velocity_rad_s", "motor_current_a"]);
    let (mut time, mut position) = (0.0, 0.0);
    for stroke in 0..30 {
        let sign = if stroke % 2 == 0 { 1.0 } else { -1.0 };
        let top = sign * (8.0 + 5.0 * f64::from(stroke % 7));
        noise.segment();
        for i in 0..300 {
            let phase = (f64::from(i) + 0.5) / 300.0;
            let velocity = top * (TAU * phase / 2.0).sin();
            let acceleration = top * (TAU / 2.0 / 1.2) * (TAU * phase / 2.0).cos();
            time += 0.004;
            position += velocity * 0.004;
            let torque = 2e-4 * acceleration + 0.03 * sign + 1.5e-3 * velocity + 0.004 + 3e-4 * velocity.abs();
            table.push_row(&[time, position, velocity, (torque + noise.next(2.0 * phase - 1.0, sign)) / 0.08]);
        }
    }
    RunTable::new(meta(Kind::Friction), table)
}

/// Three repeats of four speeds in both directions, 1.2 s each at 500 Hz. `difference(angle, velocity, time)`.
fn turns(seed: u64, difference: fn(f64, f64, f64) -> f64) -> Result<RunTable, TableFault> {
    let mut noise = Noise::new(seed, 4e-4, 1.5e-4);
    let mut table =
        trace(&["time_s", "reference_position_rad", "test_position_rad", "velocity_rad_s", "segment", "repeat"]);
    let (mut time, mut position, mut segment) = (0.0, 0.0, 0.0);
    for repeat in [0.0, 1.0, 2.0] {
        for velocity in [3.0f64, -3.0, 7.0, -7.0, 14.0, -14.0, 25.0, -25.0] {
            noise.segment();
            for i in 0..600 {
                time += 0.002;
                position += velocity * 0.002;
                let error =
                    difference(position, velocity, time) + noise.next(f64::from(i) / 299.5 - 1.0, velocity.signum());
                let wrap = |angle: f64| angle.rem_euclid(TAU);
                table.push_row(&[time, wrap(position), wrap(position + error), velocity, segment, repeat]);
            }
            segment += 1.0;
        }
    }
    RunTable::new(meta(Kind::Encoder), table)
}

/// Three repeats of up and down to ten torques, 1 s each at 250 Hz. `torsion(torque, state)`, where the state is an
/// elastic element that slips gradually beyond 4 Nm: dz = (1 − z·sgn dτ)·dτ/4.
fn sweeps(seed: u64, torsion: fn(f64, f64) -> f64) -> Result<RunTable, TableFault> {
    let mut noise = Noise::new(seed, 1e-4, 4e-5);
    let mut table =
        trace(&["time_s", "motor_position_rad", "link_position_rad", "link_torque_nm", "segment", "repeat"]);
    let (mut time, mut segment, mut torque, mut state) = (0.0f64, 0.0, 0.0f64, 0.0f64);
    for repeat in [0.0, 1.0, 2.0] {
        for peak in [12.0, -12.0, 24.0, -24.0, 36.0, -36.0, 20.0, -20.0, 40.0, -40.0] {
            noise.segment();
            let start = torque;
            for i in 0..250 {
                let share = (f64::from(i) + 1.0) / 250.0;
                let next = start + (peak - start) * share;
                // Many small steps, so that the state is that of the continuous element.
                for _ in 0..8 {
                    let step = (next - torque) / 8.0;
                    state += (1.0 - state * step.signum()) * step / 4.0;
                }
                torque = next;
                time += 0.004;
                let direction = (peak - start).signum();
                let link = 0.3 * (0.2 * time).sin() + 0.01 * torque;
                let twist = torsion(torque, state) + noise.next(2.0 * share - 1.0, direction);
                table.push_row(&[time, 50.0 * (link + twist), link, torque, segment, repeat]);
            }
            segment += 1.0;
        }
    }
    RunTable::new(meta(Kind::Stiffness), table)
}

/// Three repeats of three speeds with the current up and down, 2 s for each leg at 250 Hz. `torque(current, velocity,
/// time)`.
fn ramps(seed: u64, torque: fn(f64, f64, f64) -> f64) -> Result<RunTable, TableFault> {
    let mut noise = Noise::new(seed, 4e-3, 1.5e-3);
    let mut table = trace(&["time_s", "brake_current_a", "brake_torque_nm", "velocity_rad_s", "segment", "repeat"]);
    let (mut time, mut segment) = (0.0, 0.0);
    for repeat in [0.0, 1.0, 2.0] {
        for velocity in [2.0, 8.0, 20.0] {
            for up in [true, false] {
                noise.segment();
                for i in 0..500 {
                    let share = (f64::from(i) + 0.5) / 500.0;
                    let current = if up { share } else { 1.0 - share };
                    time += 0.004;
                    let direction = if up { 1.0 } else { -1.0 };
                    let held = torque(current, velocity, time) + noise.next(2.0 * share - 1.0, direction);
                    table.push_row(&[time, current, held, velocity, segment, repeat]);
                }
                segment += 1.0;
            }
        }
    }
    RunTable::new(meta(Kind::Brake), table)
}
