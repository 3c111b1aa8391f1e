//! Tracking errors of each compensation method: ρ₁ = Σ|θ_d − θ|, ρ₂ = Σ(θ_d − θ)², ρ_max (eq. 4.9, 4.10), and their RMS,
//! each over one period. The reported values are means over the rounds. Their intervals come from the scatter between
//! rounds: they contain the drift of friction within the run, but not the error of the friction that is compensated.
//!
//! A velocity loop has no position reference, so that the initial state of its integrator shifts the whole
//! trajectory. Therefore the first period is omitted, and the mean of the error is removed in each period.

use super::Method;
use super::cause;
use crate::findings::{Mean, Unusable, quantity};
use crate::identification::{Axis, Figure, Form, Identification, Mark, Series, Verdict};
use jointbench_instrument::RunTable;
use jointbench_model::words;

/// Averaging time of the drive current before the comparison with the feedforward.
const WINDOW_S: f64 = 0.1;
/// Largest number of samples in a figure.
const SHOWN: usize = 1500;

/// Reported figures of each method: name, symbol, title and unit.
pub(super) const FIGURES: [[&str; 4]; 8] = [
    ["rho_1", "ρ₁", "Sum of absolute errors over a period", "rad"],
    ["rho_2", "ρ₂", "Sum of squared errors over a period", "rad²"],
    ["rho_max", "ρ_max", "Maximum error", "rad"],
    ["ratio", "ρ₁/ρ₁₀", "Sum of the errors, fraction of uncompensated", ""],
    ["rms", "e_rms", "RMS error", "rad"],
    ["shift", "t_e", "Time shift of the motion, positive if late", "s"],
    ["sign_changes", "n_±", "Sign changes of the feed-forward in a period", ""],
    ["over", "Δτ", "Feed-forward minus drive torque", "Nm"],
];

/// One compensation method with its measured results. The series are those of the first round.
pub(super) struct Followed {
    pub method: Method,
    time_s: Vec<f64>,
    /// Reference at the link (rad/s).
    pub velocity_rad_s: Vec<f64>,
    /// θ_d relative to the position of the first row (rad).
    reference_rad: Vec<f64>,
    /// θ_d − θ at the link, without its mean over the period (rad).
    pub error_rad: Vec<f64>,
    /// ρ₁, ρ₂, ρ_max, RMS, time shift and sign changes of the feedforward in a period, of each round.
    rounds: Vec<[f64; 6]>,
    /// Largest feedforward in excess of the friction that the drive overcomes and its noise. A value of 0 or less means
    /// never active (motor) (Nm).
    over_nm: f64,
}

impl Followed {
    /// From whole periods. `changed`: whether the feedforward has changed its sign since the row before.
    #[allow(clippy::too_many_arguments)]
    pub fn of(
        method: Method,
        time_s: Vec<f64>,
        velocity_rad_s: Vec<f64>,
        reference_rad: Vec<f64>,
        mut error_rad: Vec<f64>,
        changed: &[bool],
        period_s: f64,
        over_nm: f64,
    ) -> Self {
        let number = |i: usize| ((time_s[i] - time_s[0]) / period_s) as usize;
        let mut periods = Vec::new();
        let mut first = 0;
        while first < time_s.len() {
            let end = (first..time_s.len()).find(|i| number(*i) != number(first)).unwrap_or(time_s.len());
            let (error, velocity) = (&mut error_rad[first..end], &velocity_rad_s[first..end]);
            let mean = error.iter().sum::<f64>() / error.len() as f64;
            error.iter_mut().for_each(|e| *e -= mean);
            periods.push(figures_of_period(error, velocity, &changed[first..end]));
            first = end;
        }
        let mean = |figure: usize| periods.iter().map(|period| period[figure]).sum::<f64>() / periods.len() as f64;
        let rounds = vec![std::array::from_fn(mean)];
        Self { method, time_s, velocity_rad_s, reference_rad, error_rad, rounds, over_nm }
    }

    /// All rounds of a method. `None`: it has none.
    fn all(period_s: f64, run: &RunTable, method: Method) -> Option<Self> {
        let mut rounds = (0..).map_while(|round| follow(period_s, run, method, round));
        let first = rounds.next()?;
        Some(rounds.fold(first, |mut all, round| {
            all.rounds.extend(round.rounds);
            all.over_nm = all.over_nm.max(round.over_nm);
            all
        }))
    }

    /// A figure, averaged over the rounds; its interval is the value itself with a single round.
    fn mean(&self, figure: usize) -> Mean {
        let values: Vec<f64> = self.rounds.iter().map(|round| round[figure]).collect();
        Mean::of(&values).unwrap_or(Mean { value: values[0], ci95: [values[0]; 2] })
    }

    fn rho(&self) -> [f64; 3] {
        [0, 1, 2].map(|figure| self.mean(figure).value)
    }

    pub fn rms(&self) -> f64 {
        self.mean(3).value
    }

    pub fn shift_s(&self) -> Mean {
        self.mean(4)
    }

    fn sign_changes(&self) -> Mean {
        self.mean(5)
    }

    /// ρ₁ as a fraction of that without compensation; the relative errors of both are independent.
    fn ratio(&self, none: &Self) -> Mean {
        let [above, below] = [self, none].map(|one| one.mean(0));
        let value = above.value / below.value;
        if self.method == Method::None {
            return Mean { value, ci95: [value; 2] };
        }
        let relative = |mean: Mean| (mean.ci95[1] - mean.value) / mean.value;
        let reach = value * relative(above).hypot(relative(below));
        Mean { value, ci95: [value - reach, value + reach] }
    }

    /// Each of [`FIGURES`]. `none`: the same without compensation.
    fn figures(&self, none: &Self) -> [Mean; 8] {
        let [rho_1, rho_2, rho_max, rms, shift, changes] = [0, 1, 2, 3, 4, 5].map(|figure| self.mean(figure));
        // A bound, not a mean.
        let over = Mean { value: self.over_nm, ci95: [self.over_nm; 2] };
        [rho_1, rho_2, rho_max, self.ratio(none), rms, shift, changes, over]
    }
}

fn figures_of_period(error: &[f64], velocity: &[f64], changed: &[bool]) -> [f64; 6] {
    let sum = |f: &dyn Fn(usize) -> f64| (0..error.len()).map(f).sum::<f64>();
    let squares = sum(&|i| error[i] * error[i]);
    let moved = sum(&|i| velocity[i] * velocity[i]);
    let shift_s = if moved > 0.0 { sum(&|i| error[i] * velocity[i]) / moved } else { 0.0 };
    [
        sum(&|i| error[i].abs()),
        squares,
        error.iter().fold(0.0, |most: f64, e| most.max(e.abs())),
        (squares / error.len() as f64).sqrt(),
        shift_s,
        changed.iter().filter(|changed| **changed).count() as f64,
    ]
}

pub(super) fn identify(period_s: f64, run: &RunTable) -> Result<Identification, Unusable> {
    let followed: Vec<Followed> =
        Method::ALL.into_iter().filter_map(|method| Followed::all(period_s, run, method)).collect();
    let is_there = |method: &Method| followed.iter().any(|one| one.method == *method);
    if ![Method::None, Method::Full, Method::Observer].iter().all(is_there) {
        return Err(Unusable::InsufficientData("Not all compensation methods were completed.", "Repeat the run."));
    }
    let none = &followed[0];
    let mut quantities = Vec::new();
    for one in &followed {
        let [suffix, title_of_method] = one.method.words();
        for ([name, symbol, title, unit], Mean { value, ci95 }) in FIGURES.into_iter().zip(one.figures(none)) {
            let words = [&format!("{name}_{suffix}"), symbol, title, unit];
            let ci95 = Some(ci95).filter(|[low, high]| low < high);
            quantities.push(quantity(words, value, ci95).in_configuration(title_of_method));
        }
    }
    let conclusion = Conclusion::of(&followed);
    Ok(Identification {
        verdict: if conclusion.is_clear() { Verdict::Identified } else { Verdict::Inconclusive },
        summary: conclusion.summary(none),
        advice: conclusion.advice(),
        quantities,
        figures: vec![bars(&followed), trajectories(&followed, period_s), errors(&followed)],
        ..Identification::default()
    })
}

/// What the comparison of the methods shows.
struct Conclusion<'f> {
    /// The method with the smallest sum of absolute errors, apart from none and from one that chatters.
    best: &'f Followed,
    /// Whether its error is significantly smaller than without compensation.
    helps: bool,
    /// Methods that feed more than the friction.
    active: Vec<&'static str>,
    /// The ideal Coulomb method, if it changes its sign more often than the reference.
    chatters: Option<Mean>,
}

impl<'f> Conclusion<'f> {
    /// `followed` begins with the method without compensation.
    fn of(followed: &'f [Followed]) -> Self {
        let none = &followed[0];
        // The reference changes its direction twice in a period.
        let ideal = followed.iter().find(|one| one.method == Method::IdealCoulomb).map(Followed::sign_changes);
        let chatters = ideal.filter(|changes| changes.ci95[0] > 2.0);
        let usable = followed[1..].iter().filter(|one| chatters.is_none() || one.method != Method::IdealCoulomb);
        let best = usable.min_by(|a, b| a.rho()[0].total_cmp(&b.rho()[0])).unwrap_or(none);
        Self {
            best,
            helps: best.ratio(none).ci95[1] < 1.0,
            active: followed.iter().filter(|one| one.over_nm > 0.0).map(|one| one.method.words()[1]).collect(),
            chatters,
        }
    }

    fn is_clear(&self) -> bool {
        self.helps && self.active.is_empty()
    }

    fn summary(&self, none: &Followed) -> String {
        let mut sentences = Vec::new();
        if self.helps {
            sentences.push(gain(self.best, none));
        } else {
            sentences.push(format!(
                "No method reduces the error significantly. The best, {}, has {} of the sum of absolute errors \
                 without compensation. {}",
                self.best.method.words()[1],
                words::percent(self.best.ratio(none).value),
                cause::sentences(self.best)
            ));
        }
        if let Some(changes) = self.chatters {
            sentences.push(format!(
                "Ideal Coulomb is unstable at standstill: its feed-forward changes sign {:.0} times in a period.",
                changes.value
            ));
        }
        sentences.push(match &self.active[..] {
            [] => "No method over-compensates.".to_owned(),
            methods => format!("Over-compensating methods: {}.", methods.join(", ")),
        });
        if none.rounds.len() > 1 {
            sentences.push("The intervals are the scatter between rounds, at the temperature of this run.".to_owned());
        }
        sentences.join(" ")
    }

    fn advice(&self) -> Option<String> {
        if !self.active.is_empty() {
            return Some("Reduce share, or identify friction again because the joint may be warmer.".into());
        }
        (!self.helps).then(|| "Use a slower reference, or improve the velocity loop of the drive.".into())
    }
}

/// Whether each value has another sign than the last one before it that is not zero.
fn sign_changes(values: &[f64]) -> Vec<bool> {
    let mut before = 0.0;
    let mut changes = |value: &f64| {
        let changed = before * value < 0.0;
        before = if *value == 0.0 { before } else { *value };
        changed
    };
    values.iter().map(&mut changes).collect()
}

/// The best method with its gain, and errors before and after.
fn gain(best: &Followed, none: &Followed) -> String {
    let errors = [none, best].map(|one| [one.rms(), one.rho()[2]].map(|rad| words::figure(rad, "rad")));
    format!(
        "Best method: {}. It reduces the sum of absolute errors by {}, the RMS error from {} to {} and the maximum error \
         from {} to {}.",
        best.method.words()[1],
        words::percent(1.0 - best.ratio(none).value),
        errors[0][0],
        errors[1][0],
        errors[0][1],
        errors[1][1]
    )
}

/// The reference is the commanded velocity: each set-point holds until the next one.
fn follow(period_s: f64, run: &RunTable, method: Method, round: u32) -> Option<Followed> {
    let column = |name: &str| run.column(name);
    let (time, setpoint) = (column("time_s")?, column("velocity_setpoint_rad_s")?);
    let (repeat, segment, motor) = (column("repeat")?, column("segment")?, column("motor_position_rad")?);
    let (current, fed) = (column("motor_current_a")?, column("motor_current_setpoint_a")?);
    let gear = run.meta().gear_ratio?;
    let km = run.meta().torque_constant_nm_per_a?;
    // Only the last attempt counts, if a pause caused a repetition.
    let last = (0..run.len()).rev().find(|i| repeat[*i] == f64::from(method.repeat(round)))?;
    let start = (0..=last).rev().take_while(|i| segment[*i] == segment[last]).last()?;
    let sample_s = (time[last] - time[start]) / (last - start).max(1) as f64;
    let whole = ((time[last] - time[start] + 1.5 * sample_s) / period_s).floor();
    if whole < 2.0 {
        return None;
    }
    let begins = |period: f64| (start..=last).find(|i| time[*i] - time[start] >= period * period_s - 0.5 * sample_s);
    let rows = begins(1.0)?..begins(whole).unwrap_or(last + 1);
    let first = rows.start;
    let mut reference = motor[first];
    let (mut reference_rad, mut error_rad) = (Vec::with_capacity(rows.len()), Vec::with_capacity(rows.len()));
    for i in rows.clone() {
        if i > first {
            reference += setpoint[i - 1] * (time[i] - time[i - 1]);
        }
        reference_rad.push((reference - motor[first]) / gear);
        error_rad.push((reference - motor[i]) / gear);
    }
    // The drive overcomes friction and the load.
    let load = column("link_torque_nm");
    let friction_a = |i: usize| current[i] - load.map_or(0.0, |load| load[i] / gear / km);
    let over_nm = if method == Method::None { 0.0 } else { km * over_a(&rows, time, setpoint, fed, &friction_a) };
    let time_s = rows.clone().map(|i| time[i] - time[first]).collect();
    let velocity_rad_s = rows.clone().map(|i| setpoint[i] / gear).collect();
    let changed = sign_changes(&fed[start..rows.end]).split_off(first - start);
    Some(Followed::of(method, time_s, velocity_rad_s, reference_rad, error_rad, &changed, period_s, over_nm))
}

/// The largest feedforward in excess of the friction, less its uncertainty (A); 0 without rows in one direction.
fn over_a(
    rows: &std::ops::Range<usize>,
    time: &[f64],
    setpoint: &[f64],
    fed: &[f64],
    friction_a: &dyn Fn(usize) -> f64,
) -> f64 {
    let all: Vec<usize> = rows.clone().collect();
    let window = ((WINDOW_S * all.len() as f64 / (time[rows.end - 1] - time[rows.start])) as usize).max(1);
    // A window across a reversal is not evaluated, because friction changes its sign there.
    let one_way = |chunk: &&[usize]| chunk.iter().all(|i| setpoint[*i] * setpoint[chunk[0]] > 0.0);
    let over = |chunk: &[usize]| {
        let side = setpoint[chunk[0]].signum();
        chunk.iter().map(|i| side * (fed[*i] - friction_a(*i))).sum::<f64>() / chunk.len() as f64
    };
    // The largest of hundreds of noise means is about four standard deviations.
    let steps = rows.clone().skip(1).map(|i| (friction_a(i) - friction_a(i - 1)).powi(2));
    let noise_a = (steps.sum::<f64>() / (2.0 * all.len() as f64)).sqrt();
    let doubt_a = 4.0 * noise_a / (window as f64).sqrt();
    let over_a = all.chunks_exact(window).filter(one_way).map(over).fold(f64::NEG_INFINITY, f64::max);
    if over_a.is_infinite() { 0.0 } else { over_a - doubt_a }
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
