//! Breakaway torques over positions and directions: means, scatter, figures.

use crate::findings::{Mean, combined, directions, quantity, scatter, solve};
use crate::identification::{Axis, Direction, Figure, Form, Mark, Quantity, Series};
use jointbench_model::stats::summary::mean;
use jointbench_model::words;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Position and torque of a breakaway.
pub(in crate::catalogue) struct BreakawayPoint {
    pub link_rad: f64,
    pub torque_nm: f64,
    pub sign: f64,
}

/// Statistics of the breakaway torque.
pub(in crate::catalogue) struct Torques {
    pub mean: Mean,
    pub forward: Mean,
    pub backward: Mean,
    pub difference: (f64, [f64; 2]),
    /// Standard deviation over positions.
    pub deviation: (f64, [f64; 2]),
}

impl Torques {
    pub fn of(points: &[BreakawayPoint], step_nm: f64) -> Option<Self> {
        let of = |sign: f64| -> Vec<f64> { points.iter().filter(|b| b.sign == sign).map(|b| b.torque_nm).collect() };
        let all: Vec<f64> = points.iter().map(|b| b.torque_nm).collect();
        let [mean, forward, backward] =
            [Mean::of(&all)?, Mean::of(&of(1.0))?, Mean::of(&of(-1.0))?].map(|mean| with_resolution(mean, step_nm));
        let difference = combined((forward.value, forward.ci95), (backward.value, backward.ci95), -1.0);
        Some(Self { mean, forward, backward, difference, deviation: deviation(&all)? })
    }

    /// By least squares with gravity as a wave of the link angle. Its change with the angle is removed from `points`.
    pub fn without_gravity(points: &mut [BreakawayPoint], step_nm: f64) -> Option<Self> {
        let response: Vec<f64> = points.iter().map(|b| b.sign * b.torque_nm).collect();
        let solved = |columns: fn(f64) -> [f64; 2]| {
            let row = |b: &BreakawayPoint| {
                let ([first, second], (sine, cosine)) = (columns(b.sign), b.link_rad.sin_cos());
                [first, second, sine, cosine]
            };
            solve(&points.iter().map(row).collect::<Vec<_>>(), &response)
        };
        let both = solved(|sign| [sign, 1.0])?;
        let each = solved(|sign| [sign.max(0.0), sign.min(0.0)])?;
        let cosine = points.iter().map(|b| b.link_rad.cos()).sum::<f64>() / points.len() as f64;
        for b in points.iter_mut() {
            let (sine, cosine) = (b.link_rad.sin(), b.link_rad.cos() - cosine);
            b.torque_nm -= b.sign * (both.values[2] * sine + both.values[3] * cosine);
        }
        let mean = |value: f64, ci95: [f64; 2]| with_resolution(Mean { value, ci95 }, step_nm);
        Some(Self {
            mean: mean(both.values[0], both.ci95(0)),
            forward: mean(each.values[0], each.ci95(0)),
            backward: mean(each.values[1], each.ci95(1)),
            difference: (2.0 * both.values[1], both.ci95(1).map(|end| 2.0 * end)),
            deviation: deviation(&points.iter().map(|b| b.torque_nm).collect::<Vec<_>>())?,
        })
    }
}

/// A mean breakaway with the resolution of its ramp: equal readings differ by up to one step.
pub(in crate::catalogue) fn with_resolution(mean: Mean, step: f64) -> Mean {
    let [low, high] = mean.ci95;
    Mean { ci95: [low - step, high + step], ..mean }
}

/// Standard deviation with its interval for normal scatter.
fn deviation(all: &[f64]) -> Option<(f64, [f64; 2])> {
    let freedom = all.len() as f64 - 1.0;
    let chi_squared = ChiSquared::new(freedom).ok()?;
    let mean = mean(all);
    let squares: f64 = all.iter().map(|torque| (torque - mean).powi(2)).sum();
    let ends = [0.975, 0.025].map(|share| (squares / chi_squared.inverse_cdf(share)).sqrt());
    Some(((squares / freedom).sqrt(), ends))
}

impl Torques {
    /// `what` broke away at `count` positions, on this `side` of the gear.
    pub fn sentence(&self, what: &str, side: &str, count: usize) -> String {
        format!(
            "{what} {} ({side}, mean of {count} positions), standard deviation {}. {}.",
            words::figure(self.mean.value, "Nm"),
            words::figure(self.deviation.0, "Nm"),
            directions(what, self.difference, "Nm")
        )
    }

    /// The quantities of a result, titled by `what` broke away.
    pub fn quantities(&self, what: &str) -> Vec<Quantity> {
        let of = |name, symbol, title: &str, (value, ci95): (f64, [f64; 2])| {
            quantity([name, symbol, title, "Nm"], value, Some(ci95))
        };
        let [mean, forward, backward] = [self.mean, self.forward, self.backward].map(|mean| (mean.value, mean.ci95));
        vec![
            of("tau_b", "τ_b", &format!("{what}, mean"), mean),
            of("tau_b", "τ_b", what, forward).in_direction(Direction::Positive),
            of("tau_b", "τ_b", what, backward).in_direction(Direction::Negative),
            of("tau_b_difference", "τ_b⁺ − τ_b⁻", &format!("{what}, difference between directions"), self.difference),
            of("deviation", "s", "Standard deviation over positions", self.deviation),
        ]
    }
}

pub(in crate::catalogue) fn over_angle(points: &[BreakawayPoint], side: &str) -> Figure {
    let of = |label, sign: f64| {
        scatter(label, points.iter().filter(move |b| b.sign == sign).map(|b| (b.link_rad, b.torque_nm)))
    };
    Figure {
        name: "breakaway_over_angle".into(),
        title: "Breakaway torque over link angle".into(),
        form: Form::Polar,
        x: Axis::of("link angle", "rad"),
        y: Axis::of(&format!("breakaway torque ({side})"), "Nm"),
        series: vec![of("positive", 1.0), of("negative", -1.0)],
    }
}

pub(in crate::catalogue) fn distribution(all: &[f64], side: &str) -> Figure {
    let (low, high) = all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (v.min(l), v.max(h)));
    // Sturges' rule.
    let bins = (all.len() as f64).log2().ceil() as usize + 1;
    let width = ((high - low) / bins as f64).max(f64::MIN_POSITIVE);
    let mut counts = vec![0.0; bins];
    for value in all {
        counts[(((value - low) / width) as usize).min(bins - 1)] += 1.0;
    }
    let centres = (0..bins).map(|i| low + (i as f64 + 0.5) * width).collect();
    Figure {
        name: "distribution".into(),
        title: "Distribution of the breakaway torque".into(),
        form: Form::Cartesian,
        x: Axis::of(&format!("breakaway torque ({side})"), "Nm"),
        y: Axis::of("positions", ""),
        series: vec![Series::new("positions", Mark::Bars, centres, counts)],
    }
}
