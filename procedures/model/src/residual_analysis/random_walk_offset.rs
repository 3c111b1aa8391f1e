//! A random-walk offset that drifts over time (AR(1)), and the structure of a residual without it.
//!
//! A random walk is correlated over time. Anything that changes slowly resembles it: a drift, a temperature, or an
//! angle that is passed in one direction. There are many stretches of motion, but few independent ones. Each stretch
//! adds only the innovation that the earlier ones do not predict.

use crate::Options;
use crate::effect::Regime;
use crate::linear::basis::{Basis, dot};
use crate::preprocess::Problem;
use crate::regression::linear_model::{LinearModel, Term};
use crate::signal::Signal;
use crate::thresholds::KURTOSIS_ERRORS;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Tested variances of the drift, relative to the variance that is new in every block.
const RATIOS: [f64; 6] = [0.1, 0.4, 1.6, 6.4, 25.6, 102.4];

/// Largest number of tested changepoints.
const MOST_PLACES: usize = 200;

/// Kurtosis of a normal distribution; its standard error is √(24/n).
const NORMAL_KURTOSIS: f64 = 3.0;

/// Block means of a run in the order of time, with the fitted AR(1) offset.
pub struct Ar1Offset<'t, 'p> {
    now: &'t LinearModel<'p>,
    /// Time from the middle of the previous block to that of this block [s]; zero for the first block.
    gaps: Vec<f64>,
    memory: Ar1Parameters,
    /// −2 log likelihood of the blocks with these parameters.
    neg2_log_likelihood: f64,
    /// Residual degrees of freedom.
    free: f64,
}

/// Relative variance and correlation time [s] of the drift.
#[derive(Clone, Copy)]
struct Ar1Parameters {
    ratio: f64,
    time_s: f64,
}

const NOTHING: Ar1Parameters = Ar1Parameters { ratio: 0.0, time_s: 1.0 };

/// One step of a Kalman filter that predicts a block from the earlier ones.
struct Step {
    decay: f64,
    gain: f64,
    /// Variance of the innovation.
    variance: f64,
}

/// Filter that converts block means to innovations.
struct Filter {
    steps: Vec<Step>,
    /// Logarithm of the product of the variances.
    size: f64,
}

impl Filter {
    fn new(memory: Ar1Parameters, gaps: &[f64]) -> Self {
        let mut known = memory.ratio;
        let step = |gap: &f64| {
            let decay = (-gap / memory.time_s).exp();
            let expected = decay * decay * known + memory.ratio * (1.0 - decay * decay);
            let (variance, gain) = (expected + 1.0, expected / (expected + 1.0));
            known = gain;
            Step { decay, gain, variance }
        };
        let steps: Vec<Step> = gaps.iter().map(step).collect();
        Self { size: steps.iter().map(|step| step.variance.ln()).sum(), steps }
    }

    fn innovations(&self, values: &[f64]) -> Vec<f64> {
        let mut known = 0.0;
        let new = |(value, step): (&f64, &Step)| {
            let new = value - step.decay * known;
            known = step.decay * known + step.gain * new;
            new / step.variance.sqrt()
        };
        values.iter().zip(&self.steps).map(new).collect()
    }

    /// Smoothed offset of the blocks, estimated from all blocks before and after each one.
    fn smooth(&self, values: &[f64]) -> Vec<f64> {
        let mut known = 0.0;
        let forward = |(value, step): (&f64, &Step)| {
            known = step.decay * known + step.gain * (value - step.decay * known);
            known
        };
        let mut smooth: Vec<f64> = values.iter().zip(&self.steps).map(forward).collect();
        for i in (1..smooth.len()).rev() {
            let next = &self.steps[i];
            // The estimate of a block has the variance `gain`; the prediction of the next block has the variance
            // `variance - 1`.
            let weight = next.decay * self.steps[i - 1].gain / (next.variance - 1.0).max(f64::MIN_POSITIVE);
            smooth[i - 1] += weight * (smooth[i] - next.decay * smooth[i - 1]);
        }
        smooth
    }
}

impl<'t, 'p> Ar1Offset<'t, 'p> {
    /// `None` if neighbouring blocks are not significantly correlated.
    pub fn of(now: &'t LinearModel<'p>, options: &Options) -> Option<Self> {
        let problem = now.problem;
        let time = means(&problem.reduce.apply(problem.view.get(Signal::Time).to_vec()), problem);
        let gaps: Vec<f64> = std::iter::once(0.0).chain(time.windows(2).map(|w| (w[1] - w[0]).abs())).collect();
        let basis = now.tangent();
        let free = gaps.len() as f64 - basis.vectors().len() as f64;
        if free < 3.0 {
            return None;
        }
        let columns = of_blocks(&basis, problem);
        let response = means(&now.response(), problem);
        let (memory, least) = most_likely(&columns, &response, &gaps, free);
        let plain = neg2_log_likelihood(&columns, &response, &Filter::new(NOTHING, &gaps), free);
        if !is_more(plain - least, 2, 1.0, options) {
            return None;
        }
        Some(Self { now, gaps, memory, neg2_log_likelihood: least, free })
    }

    /// Gain in log likelihood by a term of the model, if it is not significant against the drifting offset. The test
    /// corrects for the best of this number of `effects`.
    pub fn gain(&self, term: &Term, effects: usize, options: &Options) -> Option<f64> {
        if term.effect.traits().regime == Regime::Hysteresis {
            return None;
        }
        let without = self.now.without(term.id());
        let columns = of_blocks(&without.tangent(), without.problem);
        let response = means(&without.response(), without.problem);
        let less = most_likely(&columns, &response, &self.gaps, self.free).1 - self.neg2_log_likelihood;
        (!is_more(less, term.size(), effects as f64, options)).then_some(less)
    }

    /// The residual of a model without the drifting offset.
    pub fn without_offset(&self, residual: &[f64]) -> Vec<f64> {
        let problem = self.now.problem;
        let smooth = Filter::new(self.memory, &self.gaps).smooth(&means(residual, problem));
        let mut block = 0;
        let of_row = |row: usize| {
            block += usize::from(row > 0 && problem.block[row] != problem.block[row - 1]);
            residual[row] - smooth[block]
        };
        (0..residual.len()).map(of_row).collect()
    }

    /// Innovations of the residual, and the basis of the model's columns.
    fn left(&self, filter: &Filter) -> (Basis, Vec<f64>) {
        let columns = of_blocks(&self.now.tangent(), self.now.problem);
        let basis = Basis::of(&columns.iter().map(|column| filter.innovations(column)).collect::<Vec<_>>());
        let left = basis.rest(&filter.innovations(&means(&self.now.response(), self.now.problem)));
        (basis, left)
    }

    /// Whether a coefficient of the model has a changepoint: with a step at one moment the blocks are significantly
    /// more likely, corrected for all tested steps.
    pub fn has_changepoint(&self, options: &Options) -> bool {
        let columns = self.now.columns();
        let figures: Vec<Vec<f64>> = columns.iter().map(|column| means(column, self.now.problem)).collect();
        let places: Vec<usize> = (1..self.gaps.len()).step_by(self.gaps.len().div_ceil(MOST_PLACES)).collect();
        let chances = (figures.len() * places.len()) as f64;
        [NOTHING, self.memory].into_iter().any(|memory| {
            let filter = Filter::new(memory, &self.gaps);
            let (basis, left) = self.left(&filter);
            let taken = |figure: &[f64], place: usize| {
                let step_column: Vec<f64> =
                    (0..figure.len()).map(|i| if i < place { 0.0 } else { figure[i] }).collect();
                let rest = basis.rest(&filter.innovations(&step_column));
                dot(&rest, &left).powi(2) / dot(&rest, &rest).max(f64::MIN_POSITIVE)
            };
            let all = figures.iter().flat_map(|figure| places.iter().map(|place| taken(figure, *place)));
            let rest = dot(&left, &left) - all.fold(0.0, f64::max);
            is_more(self.neg2_log_likelihood - self.free * rest.ln() - filter.size, 1, chances, options)
        })
    }

    /// Whether the innovations consist of a few events, such as a step or a bump: their kurtosis exceeds that of a
    /// normal distribution.
    pub fn is_heavy_tailed(&self) -> bool {
        let (_, news) = self.left(&Filter::new(self.memory, &self.gaps));
        let n = news.len() as f64;
        let moment = |power: i32| news.iter().map(|new| new.powi(power)).sum::<f64>() / n;
        moment(4) / moment(2).powi(2) - NORMAL_KURTOSIS > KURTOSIS_ERRORS * (24.0 / n).sqrt()
    }
}

/// Whether a gain in log likelihood by this number of parameters is significant, corrected for the number of tests.
fn is_more(gain: f64, figures: usize, chances: f64, options: &Options) -> bool {
    ChiSquared::new(figures as f64).is_ok_and(|law| chances * law.sf(gain.max(0.0)) <= options.alpha)
}

fn of_blocks(basis: &Basis, problem: &Problem) -> Vec<Vec<f64>> {
    basis.vectors().iter().map(|column| means(column, problem)).collect()
}

fn means(values: &[f64], problem: &Problem) -> Vec<f64> {
    let mut at = 0;
    let mean = |rows: &[usize]| {
        at += rows.len();
        values[at - rows.len()..at].iter().sum::<f64>() / rows.len() as f64
    };
    problem.block.chunk_by(|a, b| a == b).map(mean).collect()
}

/// The AR(1) parameters with the largest likelihood, given the columns.
fn most_likely(columns: &[Vec<f64>], response: &[f64], gaps: &[f64], free: f64) -> (Ar1Parameters, f64) {
    let whole: f64 = gaps.iter().sum();
    let times = std::iter::successors(Some(2.0 * whole / gaps.len() as f64), |time| Some(2.0 * time));
    let memories = times
        .take_while(|time| *time < 4.0 * whole)
        .flat_map(|time_s| RATIOS.map(|ratio| Ar1Parameters { ratio, time_s }));
    let likely = |memory| (memory, neg2_log_likelihood(columns, response, &Filter::new(memory, gaps), free));
    std::iter::once(NOTHING)
        .chain(memories)
        .map(likely)
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((NOTHING, f64::INFINITY))
}

/// −2 log likelihood of the blocks, given the columns.
fn neg2_log_likelihood(columns: &[Vec<f64>], response: &[f64], filter: &Filter, free: f64) -> f64 {
    let columns: Vec<Vec<f64>> = columns.iter().map(|column| filter.innovations(column)).collect();
    let left = Basis::of(&columns).rest(&filter.innovations(response));
    free * dot(&left, &left).ln() + filter.size
}
