//! The order of a wave over a partial turn: neighbouring orders may explain the data equally well.

use crate::effect::ShapeSearch;
use crate::regression::cross_validation::is_tie;
use crate::regression::linear_model::{LinearModel, Term};
use crate::report::fit::{Parameter, ParameterState};

/// How well a model explains a run with a wave of some order.
pub struct Explained {
    /// Squared error of each independent block.
    pub losses: Vec<f64>,
    /// Coefficients with their places in the term; at least those of the wave.
    pub coefficients: Vec<(usize, f64)>,
}

/// Extends the interval of an order that a partial turn does not determine, and the intervals of its coefficients.
/// `refit` returns, for a term and the place of an order in its nonlinear parameters, the fit as a function of the order.
pub fn open<F: Fn(f64) -> Explained>(
    terms: &LinearModel,
    parameters: &mut [Parameter],
    refit: impl Fn(usize, usize) -> F,
) {
    for (i, term) in terms.terms.iter().enumerate() {
        let Some(turns) = term.effect.traits().wave.map(|angle| terms.problem.view.turns(angle)).filter(|t| *t < 1.0)
        else {
            continue;
        };
        for k in (0..term.shape.len()).filter(|k| term.form.shape[*k].search == ShapeSearch::Whole) {
            let alike = alike(term, k, refit(i, k));
            let [Some((first, _)), Some((last, _))] = [alike.first(), alike.last()] else { continue };
            let is_of_term = |p: &&mut Parameter| p.effect == term.id();
            for p in parameters.iter_mut().filter(is_of_term) {
                if p.name == term.form.shape[k].name {
                    p.ci95 = [first.min(p.value), last.max(p.value)];
                    p.state = ParameterState::Unidentified;
                    p.note = Some(format!(
                        "not identified by this run, which covers {turns:.2} of a turn: {} to {} waves per turn explain it equally well, each with another amplitude, and so may a bump at this angle; a run over more of the turn determines their number",
                        p.ci95[0], p.ci95[1]
                    ));
                } else if let Some(at) = term.form.linear.iter().position(|name| *name == p.name) {
                    let coefficients = alike.iter().flat_map(|(_, coefficients)| coefficients);
                    let sizes = coefficients.filter(|(place, _)| *place == at).map(|(_, size)| *size);
                    p.ci95 = sizes.fold(p.ci95, |[low, high], size| [low.min(size), high.max(size)]);
                }
            }
        }
    }
}

/// Other orders with which the model is as good, in rising order, each with its coefficients.
fn alike(term: &Term, k: usize, refit: impl Fn(f64) -> Explained) -> Vec<(f64, Vec<(usize, f64)>)> {
    let (found, shape) = (&term.shape, term.form.shape[k]);
    let highest = shape.max.min(term.effect.info().bounds(shape.name).1);
    let own = refit(found[k]).losses;
    let other = |order: f64| {
        let Explained { losses, coefficients } = refit(order);
        is_tie(&own, &losses).then_some((order, coefficients))
    };
    let free = |order: &f64| (shape.min..=highest).contains(order) && !found.contains(order);
    let way = |step: f64| {
        (1..).map(move |k| step * f64::from(k)).map(|away| found[k] + away).take_while(free).map_while(other)
    };
    let mut alike: Vec<(f64, Vec<(usize, f64)>)> = way(-1.0).chain(way(1.0)).collect();
    alike.sort_by(|a, b| a.0.total_cmp(&b.0));
    alike
}
