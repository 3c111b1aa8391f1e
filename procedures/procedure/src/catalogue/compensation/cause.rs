//! Why no method reduces the error: the part of the reference to which the error is proportional.

use super::followed::Followed;
use crate::findings::{Mean, bounded};
use crate::thresholds::MAIN_CAUSE;
use jointbench_model::words;

/// What the error can be proportional to.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    Velocity,
    Acceleration,
    Direction,
}

/// The evidence and its physical cause, in sentences.
pub(super) fn sentences(best: &Followed) -> String {
    let parts = [Part::Velocity, Part::Acceleration, Part::Direction].map(|part| (part, share(best, part)));
    let main = parts.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, share)| *share >= MAIN_CAUSE);
    let Some((part, share)) = main else {
        return "Its error is proportional neither to the velocity nor to the acceleration nor to the sign of the \
                velocity."
            .into();
    };
    let (share, late_s) = (words::percent(share), best.shift_s());
    match part {
        Part::Velocity => {
            let shift = |mean: Mean, sign: f64| {
                let [a, b] = mean.ci95.map(|end| 1e3 * sign * end);
                bounded((1e3 * sign * mean.value, [a.min(b), a.max(b)]), "ms")
            };
            if late_s.value < 0.0 {
                format!(
                    "{share} of its squared error is a time shift: the motion is early by {}. The drive measures its \
                     velocity late. Friction retards the motion and hides a part of this shift.",
                    shift(late_s, -1.0)
                )
            } else {
                format!(
                    "{share} of its squared error is a time shift: the motion is late by {}. This is the phase lag of \
                     the velocity loop.",
                    shift(late_s, 1.0)
                )
            }
        }
        Part::Acceleration => format!(
            "{share} of its squared error is proportional to the acceleration: the torque for the inertia comes late."
        ),
        Part::Direction => format!(
            "{share} of its squared error has the sign of the velocity: Coulomb friction differs from its parameter."
        ),
    }
}

/// Share of the squared error that a part explains.
fn share(one: &Followed, part: Part) -> f64 {
    let velocity = &one.velocity_rad_s;
    let at = |i: usize| match part {
        Part::Velocity => velocity[i],
        Part::Acceleration => velocity[(i + 1).min(velocity.len() - 1)] - velocity[i.saturating_sub(1)],
        Part::Direction if velocity[i] == 0.0 => 0.0,
        Part::Direction => velocity[i].signum(),
    };
    let sum = |f: &dyn Fn(usize) -> f64| (0..velocity.len()).map(f).sum::<f64>();
    let error = &one.error_rad;
    let both = sum(&|i| error[i] * at(i));
    let squares = sum(&|i| error[i] * error[i]) * sum(&|i| at(i) * at(i));
    if squares > 0.0 { both * both / squares } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::method::Method;
    use super::*;
    use std::f64::consts::TAU;

    /// Four periods of a sinusoid with a given error.
    fn with_error(error_rad: impl Fn(f64) -> f64) -> Followed {
        let time_s: Vec<f64> = (0..4000).map(|i| f64::from(i) / 1000.0).collect();
        let followed = Followed {
            method: Method::Full,
            velocity_rad_s: time_s.iter().map(|turns| (TAU * turns).sin()).collect(),
            reference_rad: time_s.clone(),
            error_rad: time_s.iter().map(|turns| error_rad(*turns)).collect(),
            time_s,
            rounds: Vec::new(),
            over_nm: 0.0,
        };
        followed.evaluated(&[false; 4000], 1.0)
    }

    #[test]
    fn the_cause_is_the_part_that_explains_the_error() {
        let noise = |turns: f64| 1e-4 * (977.0 * TAU * turns).sin();
        let text = |error: &dyn Fn(f64) -> f64| sentences(&with_error(|turns| error(turns) + noise(turns)));
        let early = text(&|turns| -2e-3 * (TAU * turns).sin());
        assert!(early.contains("early by 2.0") && early.contains("measures its velocity late"), "{early}");
        let late = text(&|turns| 5e-3 * (TAU * turns).sin());
        assert!(late.contains("late by 5.0") && late.contains("phase lag"), "{late}");
        assert!(text(&|turns| 1e-3 * (TAU * turns).cos()).contains("proportional to the acceleration"));
        assert!(text(&|turns| 1e-3 * (TAU * turns).sin().signum()).contains("has the sign of the velocity"));
        assert!(text(&|turns| 1e-3 * (5.0 * TAU * turns).sin()).contains("neither"));
    }
}
