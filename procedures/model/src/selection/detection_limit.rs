//! Detection limits of effects that the staged search did not find.

use crate::linear::basis::dot;
use crate::regression::candidates::{CandidateSet, Regressor};
use crate::regression::linear_model::LinearModel;
use crate::regression::partial_regression::PartialRegression;
use crate::selection::acceptance::formula_error::AcceptanceThreshold;
use crate::selection::floating_search::FloatingSearch;
use crate::stats::permutation_test::{MaxTNull, Score};
use crate::thresholds::DETECTION_POWER;
use rayon::prelude::*;

/// A candidate effect that was tested and not found.
pub struct DetectionLimit<'p> {
    pub effect: &'p str,
    /// Detection limit: RMS of the smallest effect that is found with 80 % power.
    pub detectable_rms: f64,
}

impl<'p> FloatingSearch<'_, 'p> {
    pub fn detection_limits(&self) -> Vec<DetectionLimit<'p>> {
        detection_limits(&self.now, self.library, &self.withdrawn, self.threshold())
    }
}

/// Detection limit of each effect that is not in the model. It is the largest over the forms of the effect, at the
/// median of the tested nonlinear parameters.
fn detection_limits<'p>(
    end: &LinearModel<'p>,
    library: &CandidateSet<'p>,
    withdrawn: &[&'p str],
    threshold: AcceptanceThreshold,
) -> Vec<DetectionLimit<'p>> {
    let partial = PartialRegression::of(end);
    let n = end.problem.rows() as f64;
    let least = threshold.least_share(partial.sse) * partial.sse;
    let is_out = |id| !end.contains(id) && !withdrawn.contains(&id);
    let candidates: Vec<&Regressor> = library.candidates.iter().filter(|c| is_out(c.id())).collect();
    let looked_for: Vec<Tested> = candidates.into_par_iter().filter_map(|c| Tested::new(c, &partial)).collect();
    let scores: Vec<&Score> = looked_for.iter().map(|looked| &looked.score).collect();
    let clear =
        MaxTNull::new(&scores, threshold.options.flips, threshold.options.seed).quantile(1.0 - threshold.options.alpha);
    let found = |looked: &&Tested| {
        let clear =
            partial.deciding(&looked.candidate.columns).map_or(f64::INFINITY, |by| looked.score.needed(clear, by));
        ((clear * looked.noise).max(least.sqrt()) / looked.noise + DETECTION_POWER) * looked.scatter() / n.sqrt()
    };
    let middles: Vec<&Tested> = looked_for.chunk_by(Tested::is_formed_as).filter_map(Tested::middle).collect();
    let rms: Vec<f64> = middles.par_iter().map(found).collect();
    let mut out: Vec<DetectionLimit> = Vec::new();
    for (looked, detectable_rms) in middles.into_iter().zip(rms) {
        let effect = looked.candidate.id();
        match out.iter_mut().find(|s| s.effect == effect) {
            Some(s) => s.detectable_rms = s.detectable_rms.max(detectable_rms),
            None => out.push(DetectionLimit { effect, detectable_rms }),
        }
    }
    out
}

/// Statistics of a candidate, computed from the data rows.
struct Tested<'a, 'p> {
    candidate: &'a Regressor<'p>,
    score: Score,
    /// Scatter of the coefficient, expressed as the square root of the squared error that it explains.
    noise: f64,
    /// Part of the effect that is orthogonal to the model; the columns of the model explain the rest.
    visible: f64,
}

impl<'a, 'p> Tested<'a, 'p> {
    fn new(candidate: &'a Regressor<'p>, partial: &PartialRegression) -> Option<Self> {
        let orthogonalized = partial.orthogonalized(&candidate.columns);
        let sums = partial.sums(&candidate.columns, &orthogonalized);
        let noise = sums
            .iter()
            .zip(orthogonalized.squares())
            .map(|(s, square)| (dot(s, s) / square).sqrt())
            .reduce(f64::max)?;
        Some(Self { candidate, score: Score::new(&sums), noise, visible: orthogonalized.visible })
    }

    fn is_formed_as(&self, other: &Self) -> bool {
        self.candidate.id() == other.candidate.id() && self.candidate.form.name == other.candidate.form.name
    }

    /// The scatter in units of the whole effect.
    fn scatter(&self) -> f64 {
        self.noise / self.visible.sqrt()
    }

    fn middle(shapes: &[Self]) -> Option<&Self> {
        let mut shapes: Vec<&Self> = shapes.iter().collect();
        shapes.sort_by(|a, b| a.scatter().total_cmp(&b.scatter()));
        shapes.get(shapes.len() / 2).copied()
    }
}
