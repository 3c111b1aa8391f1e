//! Removes an added effect whose size or shape the data does not determine.

use crate::inference::intervals::intervals;
use crate::preprocess::Prepared;
use crate::regression::cross_validation::validation_losses;
use crate::regression::linear_model::{LinearModel, Term};
use crate::report::fit::{Parameter, ParameterState};
use crate::selection::floating_search::FloatingSearch;
use crate::thresholds::{LARGER_PART, LEFT_SHARE};

/// Doubts about an effect that the data leaves open.
#[derive(Clone, Copy, Default)]
pub struct Undetermined {
    /// All its coefficients can be zero, even if only because of a trade-off with its nonlinear parameters.
    coefficients: bool,
    /// All its coefficients can be zero with fixed nonlinear parameters, too. Otherwise the trade-off alone is no
    /// reason to doubt the effect.
    size: bool,
    /// A nonlinear parameter lies at the bound of the identifiable range, or a coefficient beyond its physical bound.
    shape: bool,
}

impl Undetermined {
    pub fn of(term: &Term, terms: &LinearModel, parameters: &[Parameter], prepared: &Prepared) -> Self {
        let is_of_term = |p: &&Parameter| p.effect == term.id();
        let sudden = term.effect.traits().exponent_parameter;
        let mut others = parameters.iter().filter(is_of_term).filter(|p| sudden != Some(p.name.as_str()));
        // One of the two coefficients of a wave may be zero.
        let any = |parameters: &[Parameter]| {
            let mut coefficients =
                parameters.iter().filter(is_of_term).filter(|p| term.form.linear.contains(&p.name.as_str()));
            coefficients.any(|p| p.state != ParameterState::Unidentified)
        };
        let held = || intervals(&terms.held(term.id()), prepared.motion).parameters;
        Self {
            coefficients: !any(parameters),
            size: !any(parameters) && !any(&held()),
            shape: others.any(|p| p.state == ParameterState::AtBound),
        }
    }

    pub fn any(self) -> bool {
        self.size || self.shape
    }
}

/// Whether a model identifies the size and shape of an effect.
pub fn is_identified<'p>(with: &LinearModel<'p>, term: &Term<'p>, prepared: &Prepared) -> bool {
    let undetermined = Undetermined::of(term, with, &intervals(with, prepared.motion).parameters, prepared);
    !undetermined.coefficients && !undetermined.shape
}

/// An added effect whose size or shape the data does not determine, and whose removal hardly increases the validation
/// error. If its size can be zero, another cause is possible: then the effect has to be worth the larger part of the
/// error without it. With structure from outside the library no size counts as identified, because a part of that
/// structure can be in it.
pub fn unidentified<'p>(search: &FloatingSearch<'_, 'p>) -> Option<&'p str> {
    let prepared = search.prepared;
    let parameters = intervals(&search.now, prepared.motion).parameters;
    let present: f64 = validation_losses(&search.now).iter().sum();
    let open = search.added().filter_map(|term| {
        let undetermined = Undetermined::of(term, &search.now, &parameters, prepared);
        let without: f64 = validation_losses(&search.now.without(term.id())).iter().sum();
        let share = 1.0 - present / without;
        // An effect with open size and shape is removed if another effect is confounded with it.
        let is_open = undetermined.coefficients && undetermined.shape;
        let is_removed = match is_open || undetermined.size {
            true => share < LARGER_PART || is_open && !search.stand_ins(term).is_empty(),
            false => (search.unmodelled_structure || undetermined.any()) && share < LEFT_SHARE,
        };
        is_removed.then_some((term.id(), share))
    });
    open.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(id, _)| id)
}

#[cfg(test)]
mod tests {
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn an_effect_whose_size_may_be_zero_is_unidentified() {
        let removed = |offset: f64| {
            let tiny = Tiny::new(Kind::Friction, &["coulomb"], |row| offset + 5.0 * row.direction + row.scatter);
            tiny.removed(&["direction_offset"], super::unidentified)
        };
        assert_eq!(removed(0.0).as_deref(), Some("direction_offset"));
        assert_eq!(removed(2.0), None);
    }
}
