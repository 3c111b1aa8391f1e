//! An added effect whose size or shape the run does not decide.

use crate::inference::intervals::intervals;
use crate::preprocess::Prepared;
use crate::regression::cross_validation::held_out;
use crate::regression::linear_model::{LinearModel, Term};
use crate::report::fit::{Parameter, ParameterState};
use crate::selection::floating_search::FloatingSearch;
use crate::thresholds::{NEEDED_WHERE_OPEN, NEEDED_WITHOUT_SIZE, NEEDED_WITHOUT_SIZE_AND_SHAPE};

/// What the run leaves open about an effect.
#[derive(Clone, Copy, Default)]
pub struct Doubt {
    /// Its factors could all be zero, be it because they trade off with the shape.
    of_factors: bool,
    /// They could with the shape held as well. What is open only because of the shape is no reason to doubt the effect.
    of_size: bool,
    /// Its shape lies at the edge of what the run can speak about, or a factor beyond what is physically possible.
    of_shape: bool,
}

impl Doubt {
    pub fn of(term: &Term, terms: &LinearModel, parameters: &[Parameter], prepared: &Prepared) -> Self {
        let own = |p: &&Parameter| p.effect == term.id();
        let sudden = term.effect.exponent_parameter();
        let mut others = parameters.iter().filter(own).filter(|p| sudden != Some(p.name.as_str()));
        // Of a wave's two factors one may well be zero.
        let is_there = |parameters: &[Parameter]| {
            let mut factors = parameters.iter().filter(own).filter(|p| term.form.linear.contains(&p.name.as_str()));
            factors.any(|p| p.state != ParameterState::Unidentified)
        };
        let held = || intervals(&terms.held(term.id()), prepared.motion).parameters;
        Self {
            of_factors: !is_there(parameters),
            of_size: !is_there(parameters) && !is_there(&held()),
            of_shape: others.any(|p| p.state == ParameterState::AtBound),
        }
    }

    pub fn is_there(self) -> bool {
        self.of_size || self.of_shape
    }
}

/// A model says how large an effect is, and of which shape.
pub fn is_decided<'p>(with: &LinearModel<'p>, term: &Term<'p>, prepared: &Prepared) -> bool {
    let doubt = Doubt::of(term, with, &intervals(with, prepared.motion).parameters, prepared);
    !doubt.of_factors && !doubt.of_shape
}

/// An added effect whose size or shape the run does not decide, and without which held-out error is hardly larger. Where it
/// decides neither, something else may show in its place: there it has to take half of the error away, and a third where it
/// could be nothing whatever its shape. Beside structure from outside the library no size is decided: a part of that may be in it.
pub fn undecided<'p>(search: &FloatingSearch<'_, 'p>, prepared: &Prepared) -> Option<&'p str> {
    let parameters = intervals(&search.now, prepared.motion).parameters;
    let present: f64 = held_out(&search.now).iter().sum();
    let open = search.added().filter_map(|term| {
        let doubt = Doubt::of(term, &search.now, &parameters, prepared);
        let more = held_out(&search.now.without(term.id())).iter().sum::<f64>() / present - 1.0;
        let goes = match doubt.of_factors && doubt.of_shape {
            // Of two that this run cannot tell apart not the one of which it decides nothing.
            true => more < NEEDED_WITHOUT_SIZE_AND_SHAPE || !search.stand_ins(term).is_empty(),
            false if doubt.of_size => more < NEEDED_WITHOUT_SIZE,
            false => (search.unmodelled_structure || doubt.is_there()) && more < NEEDED_WHERE_OPEN,
        };
        goes.then_some((term.id(), more))
    });
    open.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(id, _)| id)
}
