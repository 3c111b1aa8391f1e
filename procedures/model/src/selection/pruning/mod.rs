//! Rules that remove an added effect from a model, one file for each rule, and the list in which they run.

pub(crate) mod infeasible;
pub(crate) mod insignificant;
pub(crate) mod local_bump;
pub(crate) mod mutually_cancelling;
pub(crate) mod partial_explanation;
pub(crate) mod random_walk;
pub(crate) mod redundant;
pub(crate) mod spurious;
pub(crate) mod swapped;
pub(crate) mod unidentified;

use crate::report::reasons::RemovalReason;
use crate::residual_analysis::{lack_of_fit, maps::Maps};
use crate::selection::floating_search::{FloatingSearch, Found};
use std::cell::OnceCell;

/// The point of the search at which a rule runs.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Point {
    /// Before each addition.
    EachMove,
    /// When no candidate passes.
    NoCandidate,
    /// When no candidate passes and no other rule rejects an effect, a limited number of times.
    Exchange,
    /// When no candidate passes and no effect is exchanged.
    End,
    /// At the end, on the structure that remains.
    Structure,
}

/// A rejected effect.
pub(crate) struct Rejected<'p> {
    pub id: &'p str,
    /// The effect that replaces it.
    pub replacement: Option<Found<'p>>,
}

/// A rule that rejects at most one added effect.
struct Rule {
    reason: RemovalReason,
    point: Point,
    rejected: for<'p> fn(&Trial<'_, '_, 'p>) -> Option<Rejected<'p>>,
}

/// All rules by name, in the order in which they run.
const RULES: [(&str, Rule); 10] = {
    use Point::{EachMove, End, Exchange, NoCandidate, Structure};
    use RemovalReason as Why;
    [
        ("redundant", rule(Why::Redundant, EachMove, |trial| plain(trial.search.redundant()))),
        ("infeasible", rule(Why::Infeasible, NoCandidate, |trial| plain(trial.search.infeasible(&trial.search.now)))),
        (
            "mutually cancelling",
            rule(Why::MutuallyCancelling, NoCandidate, |trial| plain(trial.search.mutually_cancelling())),
        ),
        ("insignificant", rule(Why::Insignificant, NoCandidate, |trial| plain(trial.search.insignificant()))),
        ("swapped", rule(Why::Swapped, Exchange, |trial| trial.search.swapped())),
        ("random walk", rule(Why::RandomWalk, End, |trial| plain(trial.search.follows_random_walk()))),
        ("unidentified", rule(Why::Unidentified, End, |trial| plain(unidentified::unidentified(trial.search)))),
        (
            "partial explanation",
            rule(Why::PartialExplanation, Structure, |trial| plain(partial_explanation::partially_explained(trial))),
        ),
        ("spurious", rule(Why::Spurious, Structure, |trial| plain(spurious::spurious(trial)))),
        ("local bump", rule(Why::PartialExplanation, Structure, |trial| plain(local_bump::bump(trial.search)))),
    ]
};

const fn rule(
    reason: RemovalReason,
    point: Point,
    rejected: for<'p> fn(&Trial<'_, '_, 'p>) -> Option<Rejected<'p>>,
) -> Rule {
    Rule { reason, point, rejected }
}

/// A rejection without a replacement.
fn plain(id: Option<&str>) -> Option<Rejected<'_>> {
    id.map(|id| Rejected { id, replacement: None })
}

/// The search with the residual maps of its model, which most rules do not need.
pub(crate) struct Trial<'s, 'l, 'p> {
    pub search: &'s FloatingSearch<'l, 'p>,
    maps: OnceCell<Maps>,
}

impl<'s, 'l, 'p> Trial<'s, 'l, 'p> {
    pub fn new(search: &'s FloatingSearch<'l, 'p>) -> Self {
        Self { search, maps: OnceCell::new() }
    }

    /// The first effect that a rule of this point rejects, with the reason.
    pub fn rejected(&self, point: Point) -> Option<(Rejected<'p>, RemovalReason)> {
        let mut of_point = RULES.iter().map(|(_, rule)| rule).filter(|rule| rule.point == point);
        of_point.find_map(|rule| Some(((rule.rejected)(self)?, rule.reason)))
    }

    pub fn maps(&self) -> &Maps {
        self.maps.get_or_init(|| self.search.maps_of(&self.search.now))
    }

    /// The axis over which structure remains.
    pub fn axis(&self) -> Option<&str> {
        lack_of_fit::structured(self.maps())
    }

    pub fn into_maps(self) -> Maps {
        self.maps.into_inner().unwrap_or_else(|| self.search.maps_of(&self.search.now))
    }
}

#[cfg(test)]
mod tests {
    use super::RULES;
    use crate::selection::listed_rules;

    #[test]
    fn the_docs_list_the_rules_in_the_order_in_which_they_run() {
        assert!(RULES.is_sorted_by_key(|(_, rule)| rule.point), "the search passes its points in their order");
        listed_rules::check("pruning", &RULES.map(|(name, _)| name));
    }
}
