//! Joints with one side clamped, which twist but do not turn.

use crate::stats::summary::mean;
use crate::thresholds::HELD_IN_COMMON;
use jointbench_instrument::{Kind, RunTable};

/// Whether one side of the joint moves less than it twists. A free joint moves farther than it twists, on both
/// sides. In a clamped joint the twist equals the motion of the other side, so that no function of that motion may
/// explain it.
pub fn moves_by_twist_only(twist: &[f64], link: &[f64]) -> bool {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        high - low
    };
    let of_link = range(&mut link.iter().copied());
    let of_motor = range(&mut twist.iter().zip(link).map(|(t, q)| t + q));
    of_link.min(of_motor) < range(&mut twist.iter().copied())
}

/// Whether one side of the joint is clamped: the motions of both sides are unrelated, and the twist follows the
/// torque.
pub fn is_held(run: &RunTable) -> bool {
    let Some(gear) = run.meta().gear_ratio.filter(|_| run.kind() == Kind::Stiffness) else { return false };
    let column = |name: &str| run.column(name).unwrap_or_default();
    let (motor, link, torque) = (column("motor_position_rad"), column("link_position_rad"), column("link_torque_nm"));
    let twist: Vec<f64> = motor.iter().zip(link).map(|(m, q)| m / gear - q).collect();
    let (middle, centre) = (mean(&twist), mean(torque));
    let product =
        |f: fn(f64, f64) -> f64| twist.iter().zip(torque).map(|(q, t)| f(q - middle, t - centre)).sum::<f64>();
    moves_by_twist_only(&twist, link)
        && product(|q, t| q * t).powi(2) > HELD_IN_COMMON * product(|q, _| q * q) * product(|_, t| t * t)
}
