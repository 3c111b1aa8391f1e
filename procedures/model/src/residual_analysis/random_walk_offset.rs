//! A zero that wanders over time, and what shows beside it.
//!
//! What wanders at random is the sum of all that happened before. Neighbours in time resemble each other, and whatever changes
//! slowly, a drift, a temperature or an angle that is passed one way, looks a little like it: many stretches of motion, and few
//! independent ones. Each of them is news only by what those before it do not tell.

use crate::Options;
use crate::effect::Regime;
use crate::linear::basis::{Basis, dot};
use crate::preprocess::Problem;
use crate::regression::linear_model::{LinearModel, Term};
use crate::signal::Signal;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Sizes of the wandering that are tried, as variances beside what is new in every block.
const RATIOS: [f64; 6] = [0.1, 0.4, 1.6, 6.4, 25.6, 102.4];

/// Moments that are tried for a leap.
const MOST_PLACES: usize = 200;

/// Kurtosis of a normal law, and so many standard errors √(24/n) beyond it is no chance.
const NORMAL_KURTOSIS: f64 = 3.0;
const EVENTS: f64 = 4.0;

/// What the blocks of a run differ by, means over each, in the order of time.
pub struct Ar1Offset<'t, 'p> {
    now: &'t LinearModel<'p>,
    /// From the middle of one block to that of the next [s], the first of them none.
    gaps: Vec<f64>,
    memory: Ar1Parameters,
    /// Minus twice the logarithm of how likely the blocks are with this memory.
    neg2_log_likelihood: f64,
    /// Degrees of freedom that the model leaves.
    free: f64,
}

/// How much wanders, and for how long that is remembered [s].
#[derive(Clone, Copy)]
struct Ar1Parameters {
    ratio: f64,
    time_s: f64,
}

const NOTHING: Ar1Parameters = Ar1Parameters { ratio: 0.0, time_s: 1.0 };

/// One step of a filter that expects of a block what those before it tell.
struct Step {
    decay: f64,
    gain: f64,
    /// Variance of the news.
    variance: f64,
}

/// What turns means of blocks into news.
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

    /// What of block means wanders, as those before and after tell together.
    fn smooth(&self, values: &[f64]) -> Vec<f64> {
        let mut known = 0.0;
        let forward = |(value, step): (&f64, &Step)| {
            known = step.decay * known + step.gain * (value - step.decay * known);
            known
        };
        let mut smooth: Vec<f64> = values.iter().zip(&self.steps).map(forward).collect();
        for i in (1..smooth.len()).rev() {
            let next = &self.steps[i];
            // What is known of a block is known to `gain`, and of the next one `variance - 1` is expected.
            let weight = next.decay * self.steps[i - 1].gain / (next.variance - 1.0).max(f64::MIN_POSITIVE);
            smooth[i - 1] += weight * (smooth[i] - next.decay * smooth[i - 1]);
        }
        smooth
    }
}

impl<'t, 'p> Ar1Offset<'t, 'p> {
    /// `None` where neighbouring blocks do not resemble each other beyond chance.
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

    /// What an effect of the model gains in likelihood from block to block, where the wandering explains that as well: the
    /// best of so many `effects` would gain as much.
    pub fn gain(&self, term: &Term, effects: usize, options: &Options) -> Option<f64> {
        if term.effect.regime() == Regime::Hysteresis {
            return None;
        }
        let without = self.now.without(term.id());
        let columns = of_blocks(&without.tangent(), without.problem);
        let response = means(&without.response(), without.problem);
        let less = most_likely(&columns, &response, &self.gaps, self.free).1 - self.neg2_log_likelihood;
        (!is_more(less, term.size(), effects as f64, options)).then_some(less)
    }

    /// What a model leaves, without what wanders.
    pub fn taken_off(&self, residual: &[f64]) -> Vec<f64> {
        let problem = self.now.problem;
        let smooth = Filter::new(self.memory, &self.gaps).smooth(&means(residual, problem));
        let mut block = 0;
        let of_row = |row: usize| {
            block += usize::from(row > 0 && problem.block[row] != problem.block[row - 1]);
            residual[row] - smooth[block]
        };
        (0..residual.len()).map(of_row).collect()
    }

    /// What the model leaves of the news, and the columns that it has taken off.
    fn left(&self, filter: &Filter) -> (Basis, Vec<f64>) {
        let columns = of_blocks(&self.now.tangent(), self.now.problem);
        let basis = Basis::of(&columns.iter().map(|column| filter.innovations(column)).collect::<Vec<_>>());
        let left = basis.rest(&filter.innovations(&means(&self.now.response(), self.now.problem)));
        (basis, left)
    }

    /// A figure of the model leaps at a moment: beside that, the blocks are likelier than the best of so many leaps would
    /// make them.
    pub fn leaps(&self, options: &Options) -> bool {
        let columns = self.now.columns();
        let figures: Vec<Vec<f64>> = columns.iter().map(|column| means(column, self.now.problem)).collect();
        let places: Vec<usize> = (1..self.gaps.len()).step_by(self.gaps.len().div_ceil(MOST_PLACES)).collect();
        let chances = (figures.len() * places.len()) as f64;
        [NOTHING, self.memory].into_iter().any(|memory| {
            let filter = Filter::new(memory, &self.gaps);
            let (basis, left) = self.left(&filter);
            let taken = |figure: &[f64], place: usize| {
                let leap: Vec<f64> = (0..figure.len()).map(|i| if i < place { 0.0 } else { figure[i] }).collect();
                let own = basis.rest(&filter.innovations(&leap));
                dot(&own, &left).powi(2) / dot(&own, &own).max(f64::MIN_POSITIVE)
            };
            let all = figures.iter().flat_map(|figure| places.iter().map(|place| taken(figure, *place)));
            let rest = dot(&left, &left) - all.fold(0.0, f64::max);
            is_more(self.neg2_log_likelihood - self.free * rest.ln() - filter.size, 1, chances, options)
        })
    }

    /// What is new comes in a few events, a leap or a bump, and not everywhere a little: its kurtosis is not that of a normal
    /// law.
    pub fn is_heavy_tailed(&self) -> bool {
        let (_, news) = self.left(&Filter::new(self.memory, &self.gaps));
        let n = news.len() as f64;
        let moment = |power: i32| news.iter().map(|new| new.powi(power)).sum::<f64>() / n;
        moment(4) / moment(2).powi(2) - NORMAL_KURTOSIS > EVENTS * (24.0 / n).sqrt()
    }
}

/// A gain in likelihood by so many figures is more than the best of so many chances.
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

/// The memory with which the blocks are most likely beside columns.
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

/// Minus twice the logarithm of how likely the blocks are beside columns.
fn neg2_log_likelihood(columns: &[Vec<f64>], response: &[f64], filter: &Filter, free: f64) -> f64 {
    let columns: Vec<Vec<f64>> = columns.iter().map(|column| filter.innovations(column)).collect();
    let left = Basis::of(&columns).rest(&filter.innovations(response));
    free * dot(&left, &left).ln() + filter.size
}
