//! An effect is named only where every coefficient stays physically possible with it.

use crate::regression::linear_model::{LinearModel, Term};
use crate::selection::acceptance::formula_error::AcceptanceThreshold;
use jointbench_instrument::Kind;

impl AcceptanceThreshold<'_> {
    /// No friction becomes negative beside another: a wave over short strokes can look like a constant.
    pub fn keeps_parameters_feasible(&self, now: &LinearModel, term: &Term) -> bool {
        if self.kind != Kind::Friction {
            return true;
        }
        let mut with = now.clone();
        with.terms.push(term.clone());
        let (was, is) = (now.linear().factors, with.linear().factors);
        let mut changes = now.terms.iter().zip(was.iter().zip(&is));
        changes.all(|(t, (was, is))| !t.allows(was) || t.allows(is)) && !is_of_its_row(&with, &is)
    }
}

/// Its delay leaves the torque between the moments of its row's position and velocity: it is as late as the row is long.
fn is_of_its_row(with: &LinearModel, factors: &[Vec<f64>]) -> bool {
    let factor = |id| with.terms.iter().position(|t| t.id() == id).and_then(|at| factors[at].first());
    match (with.problem.view.constants.of_row_s, factor("signal_delay"), factor("inertia")) {
        (Some([a, b]), Some(k_j), Some(j)) => (a.min(b)..=a.max(b)).contains(&(-k_j / j)),
        _ => false,
    }
}
