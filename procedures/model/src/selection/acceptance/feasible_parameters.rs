//! A candidate enters only if every coefficient of the model stays physically possible.

use crate::selection::acceptance::Candidate;
use jointbench_instrument::Kind;

/// Rejects a candidate with impossible coefficients, and one that makes a friction coefficient negative: a wave over
/// short strokes can look like a constant.
pub(super) fn passes(candidate: &Candidate) -> bool {
    let Candidate { term, now, partial, threshold, .. } = candidate;
    if !term.allows(&partial.orthogonalized(&term.columns).coefficients()) {
        return false;
    }
    if threshold.kind != Kind::Friction {
        return true;
    }
    let mut with = (*now).clone();
    with.terms.push((*term).clone());
    let (was, is) = (now.linear().coefficients, with.linear().coefficients);
    let mut changes = now.terms.iter().zip(was.iter().zip(&is));
    changes.all(|(t, (was, is))| !t.allows(was) || t.allows(is))
}

#[cfg(test)]
mod tests {
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn a_candidate_that_makes_the_viscous_friction_negative_is_rejected() {
        let is_accepted = |viscous: f64| {
            let tiny = Tiny::new(Kind::Friction, &["viscous"], |row| {
                5.0 * row.direction + viscous * row.velocity + 0.1 * row.scatter
            });
            tiny.passes(super::passes, "coulomb", Vec::new())
        };
        assert!(is_accepted(0.2) && !is_accepted(-0.2));
    }
}
