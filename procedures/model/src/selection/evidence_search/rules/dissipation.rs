//! A candidate that corrects a friction effect is dissipative together with it: in both directions, the two take work from
//! the joint.
//!
//! Friction never drives the joint (Canudas de Wit et al. 1995, dissipativity). An asymmetry that is larger than the
//! friction itself is another torque of the same shape.

use crate::linear::basis::dot;
use crate::regression::linear_model::LinearModel;
use crate::regression::solution::Solution;
use crate::selection::evidence_search::rules::Refit;
use crate::signal::Signal;

pub(super) fn passes(refit: &Refit) -> bool {
    let model = &refit.after.main;
    let corrected = model.term(refit.id).and_then(|(term, _)| term.effect.traits().corrects);
    let Some((corrected, solution)) = corrected.zip(Solution::of(model)) else { return true };
    let velocity = model.problem.reduce.apply(model.problem.view.get(Signal::Velocity).to_vec());
    takes_work(&contribution(model, &solution, &[refit.id, corrected]), &velocity)
}

/// Torque of some effects at the rows.
fn contribution(model: &LinearModel, solution: &Solution, ids: &[&str]) -> Vec<f64> {
    let mut torque = vec![0.0; model.problem.rows()];
    for (term, places) in ids.iter().filter_map(|id| model.term(id)) {
        for (column, coefficient) in term.columns.iter().zip(&solution.coefficients[places]) {
            torque.iter_mut().zip(column).for_each(|(sum, value)| *sum += coefficient * value);
        }
    }
    torque
}

/// Whether a torque takes work from the joint in each direction.
fn takes_work(torque: &[f64], velocity: &[f64]) -> bool {
    [1.0, -1.0].into_iter().all(|direction| {
        let one_way: Vec<f64> = velocity.iter().map(|w| (direction * w).max(0.0)).collect();
        direction * dot(torque, &one_way) >= 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::takes_work;

    #[test]
    fn an_asymmetry_does_not_exceed_the_friction() {
        let velocity = [-2.0, -1.0, 1.0, 2.0];
        let with = |asymmetry: f64| velocity.map(|w: f64| w + asymmetry * w.abs());
        assert!(takes_work(&with(0.5), &velocity) && takes_work(&with(-0.9), &velocity));
        assert!(!takes_work(&with(1.5), &velocity) && !takes_work(&with(-1.5), &velocity));
    }
}
