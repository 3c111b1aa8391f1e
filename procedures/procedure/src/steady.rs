//! Criterion of a warm joint: temperature and current no longer drift between the cycles of the warm-up.

use crate::findings::legs;
use jointbench_instrument::RunTable;
use serde::{Deserialize, Serialize};

/// Longest rest that does not restart the criterion, because gears cool in minutes. After a longer one the earlier
/// cycles do not count.
pub(crate) const COOLING_S: f64 = 60.0;

/// Criterion of a warm joint, evaluated over whole cycles of warm-up steps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SteadyCriterion {
    /// Steps of one cycle; every cycle has the same speeds.
    pub cycle_steps: usize,
    /// Largest drift of the temperature.
    pub temperature_c_per_min: f64,
    /// Largest relative drift of the mean |motor current|.
    pub current_share_per_min: f64,
}

/// Evaluates the warm-up of one run. Only the steady-state part of each step counts.
#[derive(Debug, Clone)]
pub(crate) struct SteadyDetector {
    rule: SteadyCriterion,
    current: Mean,
    cycles: Vec<Mean>,
    steps: usize,
}

#[derive(Debug, Clone, Copy, Default)]
struct Mean {
    samples: f64,
    time_s: f64,
    current_a: f64,
    temperature_c: f64,
}

impl Mean {
    fn of(self, sum: f64) -> f64 {
        sum / self.samples.max(1.0)
    }
}

/// Drift rates of the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drift {
    pub temperature_c_per_min: f64,
    pub current_share_per_min: f64,
}

impl Drift {
    fn between(first: Mean, last: Mean) -> Self {
        let minutes = (last.of(last.time_s) - first.of(first.time_s)) / 60.0;
        let (before_a, after_a) = (first.of(first.current_a), last.of(last.current_a));
        Self {
            temperature_c_per_min: (last.of(last.temperature_c) - first.of(first.temperature_c)) / minutes,
            current_share_per_min: (after_a - before_a) / after_a / minutes,
        }
    }

    pub fn is_temperature_steady(&self, rule: &SteadyCriterion) -> bool {
        self.temperature_c_per_min.abs() <= rule.temperature_c_per_min
    }

    pub fn is_current_steady(&self, rule: &SteadyCriterion) -> bool {
        self.current_share_per_min.abs() <= rule.current_share_per_min
    }
}

impl SteadyDetector {
    pub fn new(rule: SteadyCriterion) -> Self {
        Self { rule, current: Mean::default(), cycles: Vec::new(), steps: 0 }
    }

    /// The state at the end of a run that is only a warm-up.
    pub fn of(rule: SteadyCriterion, run: &RunTable) -> Option<Self> {
        let [time_s, setpoint_rad_s, current_a] =
            ["time_s", "velocity_setpoint_rad_s", "motor_current_a"].map(|name| run.column(name));
        let (time_s, setpoint_rad_s, current_a) = (time_s?, setpoint_rad_s?, current_a?);
        let temperature_c = run.column("temperature_c");
        let mut watch = Self::new(rule);
        // A step that was repeated after a pause turns in the same direction as its first attempt.
        for attempts in legs(run).chunk_by(|a, b| a.direction == b.direction) {
            let rows = attempts[0].rows.start..attempts[attempts.len() - 1].rows.end;
            let plateau_rad_s = setpoint_rad_s[rows.clone()].iter().fold(0.0, |top, v: &f64| v.abs().max(top));
            for row in rows {
                if row > 0 && time_s[row] - time_s[row - 1] >= COOLING_S {
                    watch = Self::new(rule);
                }
                if setpoint_rad_s[row].abs() >= plateau_rad_s {
                    watch.sample(time_s[row], current_a[row], temperature_c.map(|c| c[row]));
                }
            }
            watch.step_done();
        }
        Some(watch)
    }

    pub fn sample(&mut self, time_s: f64, motor_current_a: f64, temperature_c: Option<f64>) {
        self.current.samples += 1.0;
        self.current.time_s += time_s;
        self.current.current_a += motor_current_a.abs();
        self.current.temperature_c += temperature_c.unwrap_or(0.0);
    }

    pub fn step_done(&mut self) {
        self.steps += 1;
        if self.steps.is_multiple_of(self.rule.cycle_steps.max(1)) {
            self.cycles.push(std::mem::take(&mut self.current));
        }
    }

    /// The drift over the last two intervals between cycles; `None` before three cycles are done.
    pub fn drift(&self) -> Option<Drift> {
        let [.., first, _, last] = self.cycles[..] else { return None };
        Some(Drift::between(first, last))
    }

    /// The same at the end of each cycle from the third on, with the mean time of that cycle (s).
    pub fn drifts(&self) -> impl Iterator<Item = (f64, Drift)> + '_ {
        self.cycles.windows(3).map(|three| (three[2].of(three[2].time_s), Drift::between(three[0], three[2])))
    }

    pub fn is_steady(&self) -> bool {
        self.drift().is_some_and(|drift| drift.is_temperature_steady(&self.rule) && drift.is_current_steady(&self.rule))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A joint that warms up with a time constant of one minute, its friction falling by a fifth.
    #[test]
    fn an_exponential_warm_up_ends_where_its_slope_falls_below_the_bound() {
        let rule = SteadyCriterion { cycle_steps: 2, temperature_c_per_min: 1.0, current_share_per_min: 0.02 };
        let mut watch = SteadyDetector::new(rule);
        let mut ended_s = None;
        for step in 0..60 {
            for tick in 0..100 {
                let time_s = f64::from(step) * 10.0 + f64::from(tick) * 0.1;
                let cold = (-time_s / 60.0).exp();
                let sign = if step % 2 == 0 { 1.0 } else { -1.0 };
                watch.sample(time_s, sign * (0.8 + 0.2 * cold), Some(45.0 - 20.0 * cold));
            }
            watch.step_done();
            if watch.is_steady() {
                ended_s = Some(f64::from(step + 1) * 10.0);
                break;
            }
        }
        // 20 °C/min · exp(−t/60 s) is 1 °C/min at t = 180 s; the mean over three cycles looks 30 s back.
        let ended_s = ended_s.unwrap();
        assert!((180.0..=240.0).contains(&ended_s), "{ended_s}");
    }

    #[test]
    fn two_cycles_give_no_drift() {
        let rule = SteadyCriterion { cycle_steps: 1, temperature_c_per_min: 1.0, current_share_per_min: 1.0 };
        let mut watch = SteadyDetector::new(rule);
        for cycle in 0..2 {
            watch.sample(f64::from(cycle), 1.0, None);
            watch.step_done();
        }
        assert!(!watch.is_steady());
    }
}
