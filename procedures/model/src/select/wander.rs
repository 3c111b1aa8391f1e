//! A zero that wanders over time, and what shows beside it.
//!
//! What wanders at random is the sum of all that happened before. Neighbours in time resemble each other, and whatever changes
//! slowly, a drift, a temperature or an angle that is passed one way, looks a little like it: many stretches of motion, and few
//! independent ones. Each of them is news only by what those before it do not tell.

use crate::Options;
use crate::effect::Stage;
use crate::linear::{Basis, dot};
use crate::prepare::Problem;
use crate::terms::{Term, Terms};
use crate::view::Signal;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Sizes of the wandering that are tried, as variances beside what is new in every block.
const RATIOS: [f64; 6] = [0.1, 0.4, 1.6, 6.4, 25.6, 102.4];

/// What the blocks of a run differ by, means over each, in the order of time.
pub struct Wander<'t, 'p> {
    now: &'t Terms<'p>,
    /// From the middle of one block to that of the next [s], the first of them none.
    gaps: Vec<f64>,
    /// Minus twice the logarithm of how likely the blocks are with this memory.
    unlikely: f64,
    /// Degrees of freedom that the model leaves.
    free: f64,
}

/// How much wanders, and for how long that is remembered [s].
#[derive(Clone, Copy)]
struct Memory {
    ratio: f64,
    time_s: f64,
}

const NOTHING: Memory = Memory { ratio: 0.0, time_s: 1.0 };

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
    fn new(memory: Memory, gaps: &[f64]) -> Self {
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

    fn news(&self, values: &[f64]) -> Vec<f64> {
        let mut known = 0.0;
        let new = |(value, step): (&f64, &Step)| {
            let new = value - step.decay * known;
            known = step.decay * known + step.gain * new;
            new / step.variance.sqrt()
        };
        values.iter().zip(&self.steps).map(new).collect()
    }
}

impl<'t, 'p> Wander<'t, 'p> {
    /// `None` where neighbouring blocks do not resemble each other beyond chance.
    pub fn of(now: &'t Terms<'p>, options: &Options) -> Option<Self> {
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
        let least = most_likely(&columns, &response, &gaps, free);
        let plain = unlikely(&columns, &response, &Filter::new(NOTHING, &gaps), free);
        if !is_more(plain - least, 2, 1.0, options) {
            return None;
        }
        Some(Self { now, gaps, unlikely: least, free })
    }

    /// What an effect of the model gains in likelihood from block to block, where the wandering explains that as well: the
    /// best of so many `effects` would gain as much.
    pub fn gain(&self, term: &Term, effects: usize, options: &Options) -> Option<f64> {
        if term.effect.stage() == Stage::Memory {
            return None;
        }
        let without = self.now.without(term.id());
        let columns = of_blocks(&without.tangent(), without.problem);
        let response = means(&without.response(), without.problem);
        let less = most_likely(&columns, &response, &self.gaps, self.free) - self.unlikely;
        (!is_more(less, term.size(), effects as f64, options)).then_some(less)
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

/// The same with the memory that makes the blocks most likely.
fn most_likely(columns: &[Vec<f64>], response: &[f64], gaps: &[f64], free: f64) -> f64 {
    let whole: f64 = gaps.iter().sum();
    let times = std::iter::successors(Some(2.0 * whole / gaps.len() as f64), |time| Some(2.0 * time));
    let memories =
        times.take_while(|time| *time < 4.0 * whole).flat_map(|time_s| RATIOS.map(|ratio| Memory { ratio, time_s }));
    let memories = std::iter::once(NOTHING).chain(memories);
    memories.map(|memory| unlikely(columns, response, &Filter::new(memory, gaps), free)).fold(f64::INFINITY, f64::min)
}

/// Minus twice the logarithm of how likely the blocks are beside columns.
fn unlikely(columns: &[Vec<f64>], response: &[f64], filter: &Filter, free: f64) -> f64 {
    let columns: Vec<Vec<f64>> = columns.iter().map(|column| filter.news(column)).collect();
    let left = Basis::of(&columns).rest(&filter.news(response));
    free * dot(&left, &left).ln() + filter.size
}
