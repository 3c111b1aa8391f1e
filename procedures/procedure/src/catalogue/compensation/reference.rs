//! The reference: a periodic link velocity.

use crate::parameter::Values;
use crate::plan::PlanFault;
use std::f64::consts::TAU;

/// Points of one period.
const POINTS: u32 = 1000;

/// One period of the link velocity (rad/s), every period/[`POINTS`], from rest to rest.
pub(super) fn period(values: &Values) -> Result<Vec<f64>, PlanFault> {
    let (period_s, ramp_s) = (values.number("period_s"), values.number("ramp_s"));
    if ramp_s > 0.25 * period_s {
        return Err(PlanFault::Contradiction {
            what: format!("ramp_s = {ramp_s} is above a quarter of period_s = {period_s}"),
            cure: "reduce ramp_s, or set it to 0 for a sinusoid",
        });
    }
    let shape = |turn: f64| {
        if ramp_s == 0.0 {
            return (TAU * turn).sin();
        }
        let triangle_s = period_s * (0.25 - ((turn + 0.25).rem_euclid(1.0) - 0.5).abs());
        (triangle_s / ramp_s).clamp(-1.0, 1.0)
    };
    let amplitude_rad_s = values.number("amplitude_rad_s");
    Ok((1..=POINTS).map(|i| amplitude_rad_s * shape(f64::from(i % POINTS) / f64::from(POINTS))).collect())
}
