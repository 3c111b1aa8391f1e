//! The reference: a periodic link velocity, from the parameters or from a file.

use crate::parameter::{Parameter, Values};
use crate::plan::PlanFault;
use crate::profile::Profile;
use std::f64::consts::TAU;

/// Points of one period.
const POINTS: u32 = 1000;
/// Durations (s) of a period.
pub(super) const PERIOD_S: [f64; 2] = [0.5, 120.0];
/// Link velocity (rad/s) that counts as rest, as a fraction of the largest.
const REST: f64 = 1e-3;

/// The curve that a user brings.
pub(super) const FROM_FILE: Parameter = Parameter::curve(
    "reference",
    "Own reference over one period: link velocity; replaces amplitude, period and ramp",
    "rad/s",
    [-20.0, 20.0],
);

/// One period of the link velocity, from rest to rest.
pub(super) struct Reference {
    /// The velocity (rad/s) at the end of each step.
    pub velocity_rad_s: Vec<f64>,
    pub step_s: f64,
}

impl Reference {
    pub fn of(values: &Values) -> Result<Self, PlanFault> {
        let velocity_rad_s = match values.curve(FROM_FILE.name) {
            [] => by_formula(values)?,
            points => from_points(points)?,
        };
        Ok(Self { velocity_rad_s, step_s: period_s(values) / f64::from(POINTS) })
    }

    pub fn top_rad_s(&self) -> f64 {
        self.velocity_rad_s.iter().map(|v| v.abs()).fold(0.0, f64::max)
    }
}

/// Duration of one period.
pub(super) fn period_s(values: &Values) -> f64 {
    values.curve(FROM_FILE.name).last().map_or_else(|| values.number("period_s"), |[end_s, _]| *end_s)
}

/// A sinusoid or a trapezoid.
fn by_formula(values: &Values) -> Result<Vec<f64>, PlanFault> {
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

/// The periods follow each other, so that the curve begins and ends at rest. It has both directions, because friction
/// compensation is judged at reversals too.
fn from_points(points: &[[f64; 2]]) -> Result<Vec<f64>, PlanFault> {
    let fault = |what: String, cure| Err(PlanFault::Contradiction { what, cure });
    let (first, last) = (points[0], points[points.len() - 1]);
    let end_s = last[0];
    let [shortest_s, longest_s] = PERIOD_S;
    if !(shortest_s..=longest_s).contains(&end_s) {
        let what = format!("reference takes {end_s} s, expected {shortest_s} to {longest_s} s");
        return fault(what, "give one period of the reference");
    }
    let extreme = |pick: fn(f64, f64) -> f64| points.iter().map(|[_, v]| *v).fold(0.0, pick);
    let (lowest, highest) = (extreme(f64::min), extreme(f64::max));
    let rest_rad_s = REST * highest.max(-lowest);
    if let Some([t_s, v]) = [first, last].into_iter().find(|[_, v]| v.abs() > rest_rad_s) {
        return fault(format!("reference has {v} rad/s at {t_s} s"), "begin and end it at rest");
    }
    if lowest >= 0.0 || highest <= 0.0 {
        return fault("reference has one direction only".into(), "move in both directions within a period");
    }
    let profile = points[1..]
        .iter()
        .zip(points)
        .fold(Profile::from(0.0), |profile, ([t_s, v], [before_s, _])| profile.to(*v, t_s - before_s));
    let at = |i: u32| if i == POINTS { 0.0 } else { profile.at(end_s * f64::from(i) / f64::from(POINTS)) };
    Ok((1..=POINTS).map(at).collect())
}
