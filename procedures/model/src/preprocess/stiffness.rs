//! Stiffness runs: torsion between motor and link over the link torque.

use crate::linear::cholesky::Cholesky;
use crate::preprocess::chunks::{CHUNK_S, Source};
use crate::preprocess::design::replicates::Same;
use crate::preprocess::design::segments;
use crate::preprocess::encoder_count::encoder_count;
use crate::preprocess::held_side::moves_by_twist_only;
use crate::preprocess::{Prepared, filter, sample_s, sweeps};
use crate::signal::{Signal, Signals};
use crate::stats::summary::{mean, peak, range};
use crate::thresholds::{NOISE_ERRORS, OFF_MULTIPLES, ON_MULTIPLES};
use crate::view::Constants;
use crate::words::figure;
use crate::{ModelError, Options};
use jointbench_instrument::RunTable;
use std::collections::BTreeMap;

pub fn prepare(run: &RunTable, options: &Options) -> Result<Prepared, ModelError> {
    let column = |name: &str| run.column(name).unwrap_or_default();
    let gear = run.meta().gear_ratio.ok_or(ModelError::MissingConstant { needed: "gear_ratio" })?;
    let torque = column("link_torque_nm");
    if torque.iter().all(|t| *t == torque[0]) {
        return Err(ModelError::Constant { column: "link_torque_nm".into() });
    }
    let time_s = column("time_s").to_vec();
    let step_s = sample_s(&time_s);
    let link = column("link_position_rad");
    let mut target: Vec<f64> = column("motor_position_rad").iter().zip(link).map(|(m, l)| m / gear - l).collect();
    let repeat = segments::integers(run, "repeat");
    let zeros_rad = repeat.as_deref().and_then(|repeat| own_zeros(&mut target, repeat));
    let cutoff_hz = crate::preprocess::cutoff_hz(options, step_s)?;
    let mut signals = Signals::new(run.len());
    signals.set(Signal::Time, time_s.iter().map(|t| t - time_s[0]).collect());
    let is_held = moves_by_twist_only(&target, link);
    let quantization = quantization(column("motor_position_rad"), link, torque, gear, is_held);
    if is_held {
        signals.set(Signal::Direction, segments::trend(torque));
    }
    let derived_velocity = !is_held && motion(&mut signals, run, cutoff_hz, step_s);
    for (name, signal) in [("temperature_c", Signal::Temperature), ("repeat", Signal::Repeat)] {
        if let Some(values) = run.column(name) {
            signals.set(signal, values.to_vec());
        }
    }
    crate::preprocess::unknown_columns::keep(&mut signals, run);
    let mut source = Source {
        signals,
        target: target.into(),
        step_s,
        starts: segments::runs(run),
        runs: segments::runs(run),
        cutoff_hz,
        segment: segments::numbered(run),
        repeat,
        derived_velocity,
        time_s,
        constants: Constants { is_held, ..quantization },
    };
    let smooth = smooth(&source, torque);
    source.signals.set(Signal::Load, smooth);
    let inputs = [Signal::Velocity, Signal::Load].map(Same::Value);
    let mut prepared = sweeps::prepare(run, source, CHUNK_S, &inputs, options)?;
    // The legs of a clamped joint are those of its torque, which may have steps within a leg. Hysteresis operators
    // use the smoothed torque, all other terms the measured torque.
    if is_held {
        let measured = prepared.main.view.average(torque.to_vec());
        prepared.main.view.points.set(Signal::Load, measured);
    }
    prepared.main.view.measured_load = Some(torque.to_vec().into());
    prepared.warnings.extend(zeros_rad.map(|apart| {
        let apart = figure(apart, &prepared.unit());
        format!("motor and link have another zero in every repeat ({apart} RMS apart), as encoders that are zeroed before each: it is subtracted")
    }));
    Ok(prepared)
}

/// The constants of the set-up with the quantization error of the twist, from the counts of both encoders.
fn quantization(motor: &[f64], link: &[f64], torque: &[f64], gear: f64, is_held: bool) -> Constants {
    let count = |angle: &[f64]| if is_held { count_of_held(angle, torque) } else { encoder_count(angle) };
    let (motor, link) = (count(motor) / gear, count(link));
    // Standard deviation of a uniform distribution over a count.
    let rounding = if is_held { motor.hypot(link) / 12f64.sqrt() } else { 0.0 };
    Constants { rounding, half_counts: 0.5 * (motor + link), ..Constants::default() }
}

/// The count of an encoder that moves by a few counts [rad], a power of two in a turn: the readings are multiples of
/// it, while the torque that moves the angle is continuous. Zero if no count is detected.
fn count_of_held(angle: &[f64], torque: &[f64]) -> f64 {
    let (middle, centre) = (mean(angle), mean(torque));
    let product =
        |f: &dyn Fn(f64, f64) -> f64| angle.iter().zip(torque).map(|(a, t)| f(a - middle, t - centre)).sum::<f64>();
    let slope = product(&|a, t| a * t) / product(&|_, t| t * t);
    let moved: Vec<f64> = torque.iter().map(|t| slope * (t - centre)).collect();
    let on_multiples = |values: &[f64], step: f64| {
        let (sin, cos) = values
            .iter()
            .map(|v| (std::f64::consts::TAU * v / step).sin_cos())
            .fold((0.0, 0.0), |s, v| (s.0 + v.0, s.1 + v.1));
        sin.hypot(cos) / values.len() as f64
    };
    let (low, high) = range(&moved);
    let travel = high - low;
    let mut steps =
        (8..=24).map(|bits| std::f64::consts::TAU / f64::from(1u32 << bits)).filter(|step| 2.0 * step < travel);
    let is_counted =
        |step: &f64| on_multiples(angle, *step) > ON_MULTIPLES && on_multiples(&moved, *step) < OFF_MULTIPLES;
    steps.find(is_counted).unwrap_or(0.0)
}

/// Sets the motion signals of a joint that turns. Returns whether the velocity was derived from the position.
fn motion(signals: &mut Signals, run: &RunTable, cutoff_hz: f64, step_s: f64) -> bool {
    let column = |name: &str| run.column(name).unwrap_or_default();
    let (time_s, link) = (column("time_s"), column("link_position_rad"));
    let measured = run.column("link_velocity_rad_s");
    let velocity = measured.map_or_else(
        || {
            let smooth = filter::LowPass::butterworth(4, 2.0 * cutoff_hz * step_s);
            let slope =
                |range: std::ops::Range<usize>, q: &[f64]| filter::derivative(&time_s[range], &smooth.both_ways(q, 12));
            filter::by_recording(link, &segments::runs(run), slope)
        },
        <[f64]>::to_vec,
    );
    let fastest = peak(&velocity);
    signals.set(Signal::Direction, segments::direction(&velocity, 0.01 * fastest));
    signals.set(Signal::Link, link.to_vec());
    signals.set(Signal::Position, column("motor_position_rad").to_vec());
    signals.set(Signal::Velocity, velocity);
    measured.is_none()
}

/// Subtracts a separate zero of each repeat if the zeros differ by more than the variation within the repeats.
/// Returns their RMS difference.
fn own_zeros(twist: &mut [f64], repeat: &[i64]) -> Option<f64> {
    let all = mean(twist);
    let mut sums: BTreeMap<i64, (f64, f64)> = BTreeMap::new();
    for (t, r) in twist.iter().zip(repeat) {
        let (sum, n) = sums.entry(*r).or_default();
        (*sum, *n) = (*sum + t - all, *n + 1.0);
    }
    let zero = |r: &i64| sums[r].0 / sums[r].1;
    let square = |of: f64| of * of / twist.len() as f64;
    let between: f64 = repeat.iter().map(|r| square(zero(r))).sum();
    let within: f64 = twist.iter().zip(repeat).map(|(t, r)| square(t - all - zero(r))).sum();
    (between > within).then(|| {
        twist.iter_mut().zip(repeat).for_each(|(t, r)| *t -= zero(r));
        between.sqrt()
    })
}

/// Numbers of Chebyshev polynomials to choose from.
const ORDERS: [usize; 5] = [3, 5, 8, 11, 15];

/// The torque, smoothed within the even part of each leg.
fn smooth(source: &Source, torque: &[f64]) -> Vec<f64> {
    let mut smooth = torque.to_vec();
    let chunk = source.chunk(CHUNK_S);
    for leg in source.legs() {
        let even = source.even_part(&leg, chunk);
        smooth[even.clone()].copy_from_slice(&smooth_leg(&torque[even]));
    }
    smooth
}

/// The torque of a leg without sensor noise, which would disturb hysteresis and sign terms. A filter across the
/// reversal would blur exactly what these terms depend on. One smooth curve if it leaves only noise, otherwise one
/// for each half of the leg. The measured torque is kept if no curve follows it.
fn smooth_leg(values: &[f64]) -> Vec<f64> {
    let Some(curve) = curve(values) else { return values.to_vec() };
    let left: Vec<f64> = values.iter().zip(&curve).map(|(v, c)| v - c).collect();
    if is_noise(&left) {
        return curve;
    }
    let (early, late) = values.split_at(values.len() / 2);
    [smooth_leg(early), smooth_leg(late)].concat()
}

/// Whether neighbours correlate no more than in white noise (von Neumann 1941).
fn is_noise(left: &[f64]) -> bool {
    let square: f64 = left.iter().map(|v| v * v).sum();
    let next: f64 = left.windows(2).map(|w| w[0] * w[1]).sum();
    next <= NOISE_ERRORS * square / (left.len() as f64).sqrt()
}

/// Chebyshev polynomials of the square root of the time since the start of the stretch, which follow a fast beginning
/// and a slow end. Their number is chosen by the BIC (Schwarz 1978). `None` for a stretch that is too short.
fn curve(values: &[f64]) -> Option<Vec<f64>> {
    let n = values.len();
    let most = (n / 12).min(ORDERS[ORDERS.len() - 1]);
    let terms = |i: usize| {
        let x = 2.0 * ((i as f64 + 0.5) / n as f64).sqrt() - 1.0;
        let mut t = vec![1.0, x];
        for k in 2..=most {
            t.push(2.0 * x * t[k - 1] - t[k - 2]);
        }
        t
    };
    let all: Vec<Vec<f64>> = (0..n).map(terms).collect();
    let fitted = |order: usize| {
        let p = order + 1;
        let mut gram = vec![0.0; p * p];
        let mut side = vec![0.0; p];
        for (t, v) in all.iter().zip(values) {
            for a in 0..p {
                side[a] += t[a] * v;
                (0..p).for_each(|b| gram[a * p + b] += t[a] * t[b]);
            }
        }
        let coefficients = Cholesky::new(&gram, p, 0.0).solve(&side);
        let fit: Vec<f64> = all.iter().map(|t| t.iter().zip(&coefficients).map(|(t, f)| t * f).sum()).collect();
        let sse: f64 = fit.iter().zip(values).map(|(f, v)| (f - v).powi(2)).sum();
        (n as f64 * sse.max(1e-300).ln() + p as f64 * (n as f64).ln(), fit)
    };
    let curves = ORDERS.into_iter().filter(|o| *o <= most).map(fitted);
    curves.min_by(|a, b| a.0.total_cmp(&b.0)).map(|c| c.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distant_zeros_are_subtracted_and_a_creep_is_not() {
        let twist = |i: usize| 1e-3 * (i as f64 * 0.1).sin();
        let repeat: Vec<i64> = (0..900).map(|i| i / 300).collect();
        let moved = |zeros: [f64; 3]| -> Vec<f64> { (0..900).map(|i| twist(i) + zeros[i / 300]).collect() };
        let mut apart = moved([2e-3, -1e-3, -1e-3]);
        let reported = own_zeros(&mut apart, &repeat).unwrap();
        assert!((reported - 2f64.sqrt() * 1e-3).abs() < 5e-5, "{reported}");
        let level = |r: usize| apart[300 * r..300 * (r + 1)].iter().sum::<f64>() / 300.0;
        assert!((level(0) - level(1)).abs() < 1e-9 && (level(1) - level(2)).abs() < 1e-9);
        let creep = moved([0.0, 2e-4, 3e-4]);
        let mut kept = creep.clone();
        assert_eq!((own_zeros(&mut kept, &repeat), kept), (None, creep));
    }

    #[test]
    fn a_relaxing_torque_is_followed_and_noise_is_not() {
        let truth = |i: usize| 14.0 - 28.0 * (-(i as f64) / 27.0).exp();
        let noisy: Vec<f64> = (0..300).map(|i| truth(i) + 0.03 * (i as f64 * 2.1).sin()).collect();
        let worst = smooth_leg(&noisy).iter().enumerate().map(|(i, v)| (v - truth(i)).abs()).fold(0.0, f64::max);
        assert!(worst < 0.025, "{worst}");
    }

    #[test]
    fn the_step_of_an_encoder_shows_in_its_noisy_readings() {
        let torque: Vec<f64> = (0..4000i32).map(|i| 0.02 * f64::from((i % 2000 - 1000).abs()) - 10.0).collect();
        let step = std::f64::consts::TAU / 262_144.0;
        let noise = |i: usize| 0.1 * step * (12.9898 * i as f64).sin();
        let counted = |t: &f64| (3.2e-6 * t / step).round() * step;
        let read: Vec<f64> = torque.iter().enumerate().map(|(i, t)| counted(t) + noise(i)).collect();
        let found = count_of_held(&read, &torque);
        assert!((found / step - 1.0).abs() < 1e-9, "{found}");
        let smooth: Vec<f64> = torque.iter().enumerate().map(|(i, t)| 3.2e-6 * t + noise(i)).collect();
        assert_eq!(count_of_held(&smooth, &torque), 0.0);
    }

    #[test]
    fn a_torque_that_goes_up_and_down_within_a_leg_is_not_altered() {
        let torque: Vec<f64> =
            (0..4000).map(|i| 10.0 * (0.02 * f64::from(i)).sin() + 0.02 * (2.1 * f64::from(i)).sin()).collect();
        let worst = smooth_leg(&torque).iter().zip(&torque).map(|(s, t)| (s - t).abs()).fold(0.0, f64::max);
        assert!(worst < 0.05, "{worst}");
    }
}
