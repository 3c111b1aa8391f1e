//! Rules that remove an added effect from a model, one file for each rule, and the list in which they run.

pub(crate) mod infeasible;
pub(crate) mod insignificant;
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

/// All rules, in the order in which they run.
const RULES: [Rule; 10] = {
    use Point::{EachMove, End, Exchange, NoCandidate, Structure};
    [
        rule(RemovalReason::Redundant, EachMove, |trial| plain(trial.search.redundant())),
        rule(RemovalReason::Infeasible, NoCandidate, |trial| plain(trial.search.infeasible(&trial.search.now))),
        rule(RemovalReason::MutuallyCancelling, NoCandidate, |trial| plain(trial.search.mutually_cancelling())),
        rule(RemovalReason::Insignificant, NoCandidate, |trial| plain(trial.search.insignificant())),
        rule(RemovalReason::Swapped, Exchange, |trial| trial.search.swapped()),
        rule(RemovalReason::RandomWalk, End, |trial| plain(trial.search.follows_random_walk())),
        rule(RemovalReason::Unidentified, End, |trial| plain(unidentified::unidentified(trial.search))),
        rule(RemovalReason::PartialExplanation, Structure, |trial| {
            plain(partial_explanation::partially_explained(trial))
        }),
        rule(RemovalReason::Spurious, Structure, |trial| plain(spurious::spurious(trial))),
        // A weak bump leaves no structure over an axis.
        rule(RemovalReason::PartialExplanation, Structure, |trial| plain(partial_explanation::bump(trial.search))),
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
        RULES.iter().filter(|rule| rule.point == point).find_map(|rule| Some(((rule.rejected)(self)?, rule.reason)))
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

    #[test]
    fn the_docs_list_the_rules_in_the_order_in_which_they_run() {
        let docs = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/diagnosis.md")).unwrap();
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/selection/pruning");
        let mut files: Vec<String> = (std::fs::read_dir(folder).unwrap())
            .filter_map(|file| Some(file.unwrap().file_name().to_str()?.strip_suffix(".rs")?.to_owned()))
            .filter(|name| name != "mod")
            .collect();
        files.sort();
        assert!(RULES.is_sorted_by_key(|rule| rule.point), "the search passes its points in their order");
        let name = |rule: &super::Rule| serde_json::to_value(rule.reason).unwrap().as_str().unwrap().to_owned();
        let mut rules: Vec<String> = RULES.iter().map(name).collect();
        assert_eq!(rules.pop().as_deref(), Some("partial_explanation"), "runs a second time, for a weak bump");
        let mut sorted = rules.clone();
        sorted.sort();
        assert_eq!(sorted, files, "a rule is a file of selection/pruning");
        let row = |rule: &String| docs.find(&format!("\n| {} |", rule.replace('_', " ")));
        let rows: Vec<usize> = rules.iter().map(|rule| row(rule).unwrap_or_else(|| panic!("{rule}"))).collect();
        assert!(rows.is_sorted(), "the rows of docs/diagnosis.md follow another order: {rows:?}");
    }
}
