//! Facts of a bench that is only known from a run.

use crate::bench_facts::BenchFacts;
use jointbench_instrument::bench::JointConstants;
use jointbench_instrument::units::wrapped;
use jointbench_instrument::{Kind, Limits, RunTable};
use std::f64::consts::TAU;

impl BenchFacts {
    /// A bench that can do what the run has shown.
    pub fn shown_by(run: &RunTable) -> Self {
        let largest = |name: &str| run.column(name).map(|c| c.iter().fold(0.0f64, |m, v| m.max(v.abs())));
        let meta = run.meta();
        // Any load of a stiffness run counts as a brake, with full load at 1 A if no current was recorded.
        let brake_a = match run.kind() {
            Kind::Stiffness => largest("brake_current_a").filter(|a| *a > 0.0).unwrap_or(1.0),
            _ => largest("brake_current_a").unwrap_or(0.0),
        };
        let link_nm = largest("link_torque_nm").or_else(|| largest("brake_torque_nm")).unwrap_or(0.0);
        let gear_ratio = meta.gear_ratio.unwrap_or(1.0);
        let motor_rad = motor_rad(run, gear_ratio);
        let (low, high) = motor_rad.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), q| (l.min(*q), h.max(*q)));
        let range_rad = (high - low) / gear_ratio;
        // An axis that turns continuously has no range.
        let turns_on = matches!(run.kind(), Kind::Encoder | Kind::Brake) && range_rad > TAU;
        let rated_a = meta.rated_current_a.unwrap_or(brake_a).max(f64::MIN_POSITIVE);
        Self {
            name: "shown by the run".into(),
            simulated: false,
            limits: Limits {
                motor_velocity_rad_s: speed_rad_s(run, &motor_rad),
                brake_current_a: brake_a,
                motor_current_a: f64::INFINITY,
                link_torque_nm: f64::INFINITY,
                temperature_c: f64::INFINITY,
                brake_power_w: f64::INFINITY,
            },
            constants: JointConstants {
                torque_constant_nm_per_a: meta.torque_constant_nm_per_a.unwrap_or(1.0),
                gear_ratio,
                rotor_inertia_kg_m2: meta.rotor_inertia_kg_m2.unwrap_or(0.0),
                brake_compliance_v: 0.0,
                brake_rated_current_a: rated_a,
                brake_rated_torque_nm: if brake_a > 0.0 { link_nm * rated_a / brake_a } else { 0.0 },
                link_range_rad: (range_rad.is_finite() && !turns_on).then_some(range_rad),
                load_gear_ratio: None,
            },
            has_torque_sensor: link_nm > 0.0,
            has_two_ranges: false,
            has_brake: brake_a > 0.0,
            encoder_counts: (run.kind() == Kind::Encoder)
                .then(|| [meta.reference_bits, meta.test_bits].map(|bits| f64::from(bits.unwrap_or(20)).exp2())),
            has_stage: false,
            amperes_per_volt: None,
            setpoint_interval: None,
            brake_model: None,
            compared_brake: None,
            feeds_forward: true,
        }
    }
}

/// Motor position: of an encoder bench the shaft, of a brake the position that a joint with this gear would have.
fn motor_rad(run: &RunTable, gear_ratio: f64) -> Vec<f64> {
    let column = |name: &str| run.column(name).unwrap_or_default();
    match run.kind() {
        Kind::Friction | Kind::Stiffness => column("motor_position_rad").to_vec(),
        Kind::Brake => column("position_rad").iter().map(|q| gear_ratio * q).collect(),
        Kind::Encoder => {
            let angle = column("reference_position_rad");
            let step = |pair: &[f64]| wrapped(pair[1] - pair[0]);
            let steps = angle.first().copied().into_iter().chain(angle.windows(2).map(step));
            steps
                .scan(0.0, |at, step| {
                    *at += step;
                    Some(*at)
                })
                .collect()
        }
    }
}

/// The highest speed that a run held for a tenth of a second.
fn speed_rad_s(run: &RunTable, motor_rad: &[f64]) -> f64 {
    let time_s = run.column("time_s").unwrap_or_default();
    let apart = time_s.iter().take_while(|t| **t - time_s[0] < 0.1).count().max(1);
    let runs = time_s.iter().zip(motor_rad).zip(time_s.iter().zip(motor_rad).skip(apart));
    runs.filter(|((t0, _), (t1, _))| *t1 - *t0 < 0.2)
        .map(|((t0, q0), (t1, q1))| ((q1 - q0) / (t1 - t0)).abs())
        .fold(0.0, f64::max)
}
