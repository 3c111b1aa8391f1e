//! Tracking errors of each compensation method: ρ₁ = Σ|θ_d − θ|, ρ₂ = Σ(θ_d − θ)², ρ_max, and their RMS,
//! each over one period. The reported values are means over the rounds. Their intervals come from the scatter between
//! rounds: they contain the drift of friction within the run, but not the error of the friction that is compensated.
//!
//! A velocity loop has no position reference, so that the initial state of its integrator shifts the whole
//! trajectory. Therefore the first period is omitted, and the mean of the error is removed in each period.

use super::method::Method;
use crate::findings::Mean;
use jointbench_instrument::RunTable;
use jointbench_model::stats::summary::mean;

/// Averaging time of the drive current before the comparison with the feedforward.
const WINDOW_S: f64 = 0.1;
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
    pub time_s: Vec<f64>,
    /// Reference at the link (rad/s).
    pub velocity_rad_s: Vec<f64>,
    /// θ_d relative to the position of the first row (rad).
    pub reference_rad: Vec<f64>,
    /// θ_d − θ at the link, without its mean over the period (rad).
    pub error_rad: Vec<f64>,
    /// ρ₁, ρ₂, ρ_max, RMS, time shift and sign changes of the feedforward in a period, of each round.
    pub rounds: Vec<[f64; 6]>,
    /// Largest feedforward in excess of the friction that the drive overcomes and its noise. A value of 0 or less means
    /// never active (motor) (Nm).
    pub over_nm: f64,
}

impl Followed {
    /// Removes the mean error of each period and adds the figures of this round. `changed`: whether the feed-forward has
    /// changed its sign since the row before.
    pub fn evaluated(mut self, changed: &[bool], period_s: f64) -> Self {
        let number = |t_s: f64| ((t_s - self.time_s[0]) / period_s) as usize;
        let mut periods = Vec::new();
        let mut first = 0;
        for rows in self.time_s.chunk_by(|a, b| number(*a) == number(*b)) {
            let period = first..first + rows.len();
            first = period.end;
            let error = &mut self.error_rad[period.clone()];
            let mean = mean(error);
            error.iter_mut().for_each(|e| *e -= mean);
            periods.push(figures_of_period(error, &self.velocity_rad_s[period.clone()], &changed[period]));
        }
        let mean = |figure: usize| periods.iter().map(|period| period[figure]).sum::<f64>() / periods.len() as f64;
        self.rounds.push(std::array::from_fn(mean));
        self
    }

    /// All rounds of a method. `None`: it has none.
    pub fn all(period_s: f64, run: &RunTable, method: Method) -> Option<Self> {
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

    pub fn rho(&self) -> [f64; 3] {
        [0, 1, 2].map(|figure| self.mean(figure).value)
    }

    pub fn rms(&self) -> f64 {
        self.mean(3).value
    }

    pub fn shift_s(&self) -> Mean {
        self.mean(4)
    }

    pub fn sign_changes(&self) -> Mean {
        self.mean(5)
    }

    /// ρ₁ as a fraction of that without compensation; the relative errors of both are independent.
    pub fn ratio(&self, none: &Self) -> Mean {
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
    pub fn figures(&self, none: &Self) -> [Mean; 8] {
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
    let rounds = Vec::new();
    let followed = Followed { method, time_s, velocity_rad_s, reference_rad, error_rad, rounds, over_nm };
    Some(followed.evaluated(&changed, period_s))
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
