//! Tracking errors of each compensation method: ρ₁ = Σ|θ_d − θ|, ρ₂ = Σ(θ_d − θ)², ρ_max (eq. 4.9, 4.10), and their RMS.
//! They have no interval: the scatter between periods leaves out the error of the friction that is compensated, which is
//! larger.
//!
//! A velocity loop has no position reference, so that the initial state of its integrator shifts the whole
//! trajectory. Therefore the first period is omitted, and the reference begins where the motion is closest to rest,
//! at the mean of the error.

use super::Method;
use crate::findings::{Unusable, quantity};
use crate::identification::{Axis, Figure, Form, Identification, Mark, Series, Verdict};
use jointbench_instrument::RunTable;
use jointbench_model::words;

/// Averaging time of the drive current before the comparison with the feedforward.
const WINDOW_S: f64 = 0.1;
/// Largest number of samples in a figure.
const SHOWN: usize = 1500;

/// Reported figures of each method: name, symbol, title and unit.
pub(super) const FIGURES: [[&str; 4]; 6] = [
    ["rho_1", "ρ₁", "Sum of absolute errors", "rad"],
    ["rho_2", "ρ₂", "Sum of squared errors", "rad²"],
    ["rho_max", "ρ_max", "Maximum error", "rad"],
    ["ratio", "ρ₁/ρ₁₀", "Sum of the errors, fraction of uncompensated", ""],
    ["rms", "e_rms", "RMS error", "rad"],
    ["over", "Δτ", "Feed-forward minus drive torque", "Nm"],
];

/// One compensation method with its measured results.
struct Followed {
    method: Method,
    time_s: Vec<f64>,
    /// θ_d relative to the position of the first row (rad).
    reference_rad: Vec<f64>,
    /// θ_d − θ at the link (rad).
    error_rad: Vec<f64>,
    /// Largest feedforward in excess of the total drive torque and its noise. A value of 0 or less means never active
    /// (motor) (Nm).
    over_nm: f64,
}

impl Followed {
    fn rho(&self) -> [f64; 3] {
        let sum = |f: fn(f64) -> f64| self.error_rad.iter().map(|e| f(*e)).sum::<f64>();
        [sum(f64::abs), sum(|e| e * e), self.error_rad.iter().fold(0.0, |m: f64, e| m.max(e.abs()))]
    }

    fn rms(&self) -> f64 {
        (self.rho()[1] / self.error_rad.len() as f64).sqrt()
    }

    /// Each of [`FIGURES`]. `none`: the same without compensation.
    fn figures(&self, none: &Self) -> [f64; 6] {
        let [rho_1, rho_2, rho_max] = self.rho();
        [rho_1, rho_2, rho_max, rho_1 / none.rho()[0], self.rms(), self.over_nm]
    }
}

pub(super) fn identify(period_s: f64, run: &RunTable) -> Result<Identification, Unusable> {
    let followed: Vec<Followed> = Method::ALL.into_iter().filter_map(|method| follow(period_s, run, method)).collect();
    if followed.len() < Method::ALL.len() {
        return Err(Unusable::InsufficientData("Not all compensation methods were completed.", "Repeat the run."));
    }
    let none = &followed[0];
    let mut quantities = Vec::new();
    for one in &followed {
        let [suffix, title_of_method] = one.method.words();
        for ([name, symbol, title, unit], value) in FIGURES.into_iter().zip(one.figures(none)) {
            let words = [&format!("{name}_{suffix}"), symbol, title, unit];
            quantities.push(quantity(words, value, None).in_configuration(title_of_method));
        }
    }
    let best = followed.iter().min_by(|a, b| a.rho()[0].total_cmp(&b.rho()[0]));
    let active: Vec<&str> = followed.iter().filter(|f| f.over_nm > 0.0).map(|f| f.method.words()[1]).collect();
    let gain = best.map_or_else(String::new, |best| gain(best, none));
    let summary = match &active[..] {
        [] => format!("{gain} No method over-compensates."),
        ways => format!("{gain} Over-compensating methods: {}.", ways.join(", ")),
    };
    Ok(Identification {
        verdict: if active.is_empty() { Verdict::Identified } else { Verdict::Inconclusive },
        summary,
        advice: (!active.is_empty())
            .then(|| "Reduce share, or identify friction again because the joint may be warmer.".into()),
        quantities,
        figures: vec![bars(&followed), trajectories(&followed, period_s), errors(&followed)],
        ..Identification::default()
    })
}

/// The best method with its gain, and errors before and after.
fn gain(best: &Followed, none: &Followed) -> String {
    let [_, _, _, ratio, ..] = best.figures(none);
    let errors = [none, best].map(|one| [one.rms(), one.rho()[2]].map(|rad| words::figure(rad, "rad")));
    format!(
        "Best method: {}. It reduces the sum of absolute errors by {}, the RMS error from {} to {} and the maximum error \
         from {} to {}.",
        best.method.words()[1],
        words::percent(1.0 - ratio),
        errors[0][0],
        errors[1][0],
        errors[0][1],
        errors[1][1]
    )
}

/// The reference is the commanded velocity: each set-point holds until the next one.
fn follow(period_s: f64, run: &RunTable, method: Method) -> Option<Followed> {
    let column = |name: &str| run.column(name);
    let (time, setpoint) = (column("time_s")?, column("velocity_setpoint_rad_s")?);
    let (repeat, segment, motor) = (column("repeat")?, column("segment")?, column("motor_position_rad")?);
    let (current, fed) = (column("motor_current_a")?, column("motor_current_setpoint_a")?);
    let gear = run.meta().gear_ratio?;
    let km = run.meta().torque_constant_nm_per_a?;
    // Only the last attempt counts, if a pause caused a repetition.
    let last = (0..run.len()).rev().find(|i| repeat[*i] == method as u32 as f64)?;
    let first = (0..=last).rev().take_while(|i| segment[*i] == segment[last]).last()?;
    let first = (first..last).find(|i| time[*i] - time[first] >= period_s)?;
    let rows = first..last + 1;
    let mut reference = motor[first];
    let (mut reference_rad, mut error_rad) = (Vec::with_capacity(rows.len()), Vec::with_capacity(rows.len()));
    for i in rows.clone() {
        if i > first {
            reference += setpoint[i - 1] * (time[i] - time[i - 1]);
        }
        reference_rad.push((reference - motor[first]) / gear);
        error_rad.push((reference - motor[i]) / gear);
    }
    let mean = error_rad.iter().sum::<f64>() / error_rad.len() as f64;
    error_rad.iter_mut().for_each(|e| *e -= mean);
    let window = ((WINDOW_S * rows.len() as f64 / (time[last] - time[first])) as usize).max(1);
    // A window across a reversal is not evaluated, because friction changes its sign there.
    let one_way = |chunk: &&[usize]| chunk.iter().all(|i| setpoint[*i] * setpoint[chunk[0]] > 0.0);
    let over = |chunk: &[usize]| {
        let side = setpoint[chunk[0]].signum();
        chunk.iter().map(|i| side * (fed[*i] - current[*i])).sum::<f64>() / chunk.len() as f64
    };
    let all: Vec<usize> = rows.clone().collect();
    // The largest of hundreds of noise means is about four standard deviations.
    let steps = rows.clone().skip(1).map(|i| (current[i] - current[i - 1]).powi(2));
    let noise_a = (steps.sum::<f64>() / (2.0 * rows.len() as f64)).sqrt();
    let doubt_a = 4.0 * noise_a / (window as f64).sqrt();
    let over_a = all.chunks_exact(window).filter(one_way).map(over).fold(f64::NEG_INFINITY, f64::max);
    Some(Followed {
        method,
        time_s: rows.map(|i| time[i] - time[first]).collect(),
        reference_rad,
        error_rad,
        over_nm: if method == Method::None || over_a.is_infinite() { 0.0 } else { km * (over_a - doubt_a) },
    })
}

fn errors(followed: &[Followed]) -> Figure {
    let series = followed.iter().map(|one| {
        let every = one.time_s.len().div_ceil(SHOWN);
        let pick = |values: &[f64]| values.iter().copied().step_by(every).collect();
        Series::new(one.method.words()[1], Mark::Line, pick(&one.time_s), pick(&one.error_rad))
    });
    Figure {
        name: "error_over_time".into(),
        title: "Tracking error".into(),
        form: Form::Cartesian,
        x: Axis::of("time", "s"),
        y: Axis::of("error (link)", "rad"),
        series: series.collect(),
    }
}

/// Table 4.7 as bars: each figure relative to that without compensation.
fn bars(followed: &[Followed]) -> Figure {
    let none = followed[0].rho();
    let places: Vec<f64> = (0..followed.len()).map(|i| i as f64).collect();
    let series = |i: usize| {
        let [_, _, title, _] = FIGURES[i];
        let shares = followed.iter().map(|one| one.rho()[i] / none[i]).collect();
        Series::new(&title.to_lowercase(), Mark::Bars, places.clone(), shares)
    };
    Figure {
        name: "ratio".into(),
        title: "Errors relative to no compensation".into(),
        form: Form::Cartesian,
        x: Axis::names("compensation", followed.iter().map(|one| one.method.words()[1])),
        y: Axis::of("fraction of uncompensated", ""),
        series: vec![series(0), series(1), series(2)],
    }
}

/// The reference, and its tracking without compensation and with the best method, over one period. The errors are
/// magnified by a power of ten, because they would not be visible otherwise.
fn trajectories(followed: &[Followed], period_s: f64) -> Figure {
    let by_error = |a: &&Followed, b: &&Followed| a.rho()[0].total_cmp(&b.rho()[0]);
    let none = &followed[0];
    let most_rad = none.reference_rad.iter().fold(0.0, |most: f64, at| most.max(at.abs()));
    let larger = 10f64.powf((0.5 * most_rad / none.rho()[2]).log10().floor()).clamp(1.0, 1e4);
    let shown = |label: &str, one: &Followed, at: &dyn Fn(usize) -> f64| {
        let end = one.time_s.partition_point(|t_s| *t_s <= period_s);
        let rows = || (0..end).step_by(end.div_ceil(SHOWN).max(1));
        Series::new(label, Mark::Line, rows().map(|i| one.time_s[i]).collect(), rows().map(at).collect())
    };
    let mut series = vec![shown("reference", none, &|i| none.reference_rad[i])];
    for one in [Some(none), followed.iter().min_by(by_error)].into_iter().flatten() {
        let label = format!("{} (error × {larger})", one.method.words()[1]);
        series.push(shown(&label, one, &|i| one.reference_rad[i] - larger * one.error_rad[i]));
    }
    Figure {
        name: "trajectory".into(),
        title: "Trajectory, one period".into(),
        form: Form::Cartesian,
        x: Axis::of("time", "s"),
        y: Axis::of("angle (link)", "rad"),
        series,
    }
}
