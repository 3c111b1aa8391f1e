//! Omitted-variable bias: an effect that another one imitates hardly changes the error, but its absence biases the
//! coefficients.

use crate::linear::basis::dot;
use crate::regression::candidates::Regressor;
use crate::regression::cross_validation::{is_tie, validation_losses};
use crate::regression::linear_model::{LinearModel, Term};
use crate::regression::partial_regression::PartialRegression;
use crate::regression::significance::significance;
use crate::report::reasons::AdditionReason;
use crate::selection::floating_search::FloatingSearch;
use crate::selection::forward_step::ScoredCandidate;
use crate::thresholds::{BIASED_COEFFICIENT, SAME_SHAPE};
use rayon::prelude::*;

/// An effect that hardly changes the error, with the model that includes it.
pub struct Imitated<'p> {
    pub scored: ScoredCandidate<'p>,
    pub with: LinearModel<'p>,
    /// The validation error confirms the effect.
    pub is_clear: bool,
}

impl<'p> FloatingSearch<'_, 'p> {
    /// The effect that a term with free nonlinear parameters imitates best, at the cost of a biased coefficient of
    /// the given model. A Stribeck effect that fades slowly also fits a curve over speed and a part of Coulomb
    /// friction.
    ///
    /// `decides` returns whether a model identifies an effect.
    pub fn imitated(&self, decides: impl Fn(&LinearModel<'p>, &Term<'p>) -> bool + Sync) -> Option<Imitated<'p>> {
        let can_absorb = |term: &Term| term.form.shape.iter().any(|shape| shape.is_smooth());
        if self.left == 0 || !self.now.terms.iter().any(can_absorb) {
            return None;
        }
        let partial = PartialRegression::of(&self.now);
        let mut alike: Vec<(f64, &Regressor<'p>)> = Vec::new();
        let is_open = |id| !self.now.contains(id) && !self.withdrawn.contains(&id);
        for candidate in self.library.candidates.iter().filter(|c| is_open(c.id())) {
            let orthogonalized = partial.orthogonalized(&candidate.columns);
            match alike.iter_mut().find(|known| known.1.id() == candidate.id()) {
                _ if orthogonalized.visible > 1.0 - SAME_SHAPE => {}
                Some(known) if orthogonalized.share > known.0 => *known = (orthogonalized.share, candidate),
                Some(_) => {}
                None => alike.push((orthogonalized.share, candidate)),
            }
        }
        let (present, sse) = (validation_losses(&self.now), self.now.linear().sse);
        let least_share = self.threshold().least_share(sse);
        let is_at_edge = self.added().any(Term::is_at_edge);
        let imitated = alike.into_par_iter().filter_map(|(_, candidate)| {
            let mut near = self.now.clone();
            near.terms.push(candidate.term(near.problem));
            near.refine();
            if !self.is_biased_by(&near) {
                return None;
            }
            let with = self.model_with(candidate.id());
            let term = with.terms.iter().find(|term| term.id() == candidate.id())?.clone();
            let linear = with.linear();
            let is_possible =
                with.terms.iter().zip(&linear.coefficients).all(|(term, coefficients)| term.allows(coefficients));
            // A reduction within the formula error was rejected before. It counts only if the formula of an added
            // effect has reached its bound.
            let share = 1.0 - linear.sse / sse;
            let is_remainder = (self.options.practical_share..least_share).contains(&share) && !is_at_edge;
            if !is_possible || is_remainder || !self.is_biased_by(&with) || !decides(&with, &term) {
                return None;
            }
            // The score uses the nonlinear parameters of the model with this effect; refitted without it, the other
            // terms would imitate it.
            let mut without = with.clone();
            without.terms.retain(|other| other.id() != candidate.id());
            let p_value = significance(&term, self.library, &PartialRegression::of(&without), self.options);
            let losses = validation_losses(&with);
            let validation_losses = losses.iter().sum();
            let is_clear = validation_losses < present.iter().sum() && !is_tie(&losses, &present);
            let reason = AdditionReason::OmittedVariableBias;
            let scored = ScoredCandidate {
                term,
                share,
                validation_losses,
                p_value,
                reason,
                is_without_form_error: false,
                losses,
            };
            (p_value <= self.options.alpha).then_some(Imitated { scored, with, is_clear })
        });
        let better = |a: &Imitated, b: &Imitated| a.scored.validation_losses.total_cmp(&b.scored.validation_losses);
        imitated.min_by(|a, b| b.is_clear.cmp(&a.is_clear).then(better(a, b)))
    }

    /// Whether a coefficient of the given model differs from its value in another model.
    pub(crate) fn is_biased_by(&self, other: &LinearModel<'p>) -> bool {
        biased_coefficient(&self.now, other, &self.initial_terms).is_some()
    }
}

/// A coefficient in two models.
pub struct BiasedCoefficient<'p> {
    pub term: Term<'p>,
    pub coefficient: &'p str,
    pub was: f64,
    pub is: f64,
}

/// The first coefficient of these effects whose change between two models exceeds the error.
pub fn biased_coefficient<'p>(
    was: &LinearModel<'p>,
    is: &LinearModel<'p>,
    effects: &[impl AsRef<str>],
) -> Option<BiasedCoefficient<'p>> {
    let (then, now) = (was.linear(), is.linear());
    let both = was.terms.iter().enumerate().filter(|(_, term)| effects.iter().any(|id| id.as_ref() == term.id()));
    // In another form the coefficients have another meaning.
    let same = |a: &Term, b: &Term| a.id() == b.id() && a.form.linear == b.form.linear;
    let mut both = both.filter_map(|(at, term)| Some((at, term, is.terms.iter().position(|t| same(t, term))?)));
    both.find_map(|(at, term, there)| {
        let mut pairs = (0..term.columns.len()).map(|k| (k, then.coefficients[at][k], now.coefficients[there][k]));
        let is_wrong = |k: usize, was: f64, is: f64| {
            let size = (is - was).powi(2) * dot(&term.columns[k], &term.columns[k]);
            (is - was).abs() > BIASED_COEFFICIENT * is.abs() && size > then.sse
        };
        let (k, was, is) = pairs.find(|(k, was, is)| is_wrong(*k, *was, *is))?;
        Some(BiasedCoefficient { term: term.clone(), coefficient: term.form.linear[k], was, is })
    })
}
