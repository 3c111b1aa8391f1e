//! The order of a wave over a partial turn: neighbouring orders may explain the data equally well.

use crate::effect::ShapeSearch;
use crate::preprocess::independent_blocks::independent_blocks;
use crate::regression::linear_model::{LinearModel, Term};
use crate::report::fit::{Parameter, ParameterState};
use crate::thresholds::TIE_ERRORS;

/// Extends the interval of an order that a partial turn does not determine, and the intervals of its coefficients.
pub fn open(terms: &LinearModel, residual: &[f64], parameters: &mut [Parameter]) {
    for (i, term) in terms.terms.iter().enumerate() {
        let Some(turns) = term.effect.traits().wave.map(|angle| terms.problem.view.turns(angle)).filter(|t| *t < 1.0)
        else {
            continue;
        };
        for k in (0..term.shape.len()).filter(|k| term.form.shape[*k].search == ShapeSearch::Whole) {
            let alike = alike(terms, residual, i, k);
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
                    let sizes = alike.iter().map(|(_, coefficients)| coefficients[at]);
                    p.ci95 = sizes.fold(p.ci95, |[low, high], size| [low.min(size), high.max(size)]);
                }
            }
        }
    }
}

/// Other orders with which the model is as good, in rising order, each with its coefficients.
fn alike(terms: &LinearModel, residual: &[f64], term: usize, shape: usize) -> Vec<(f64, Vec<f64>)> {
    let Term { effect, form, shape: found, .. } = &terms.terms[term];
    let bounds = form.shape[shape];
    let (block, count) = independent_blocks(terms.problem, terms.columns().len());
    let other = |order: f64| {
        let mut orders = found.clone();
        orders[shape] = order;
        let mut trial = terms.clone();
        trial.terms[term] = Term::new(*effect, form.clone(), orders, terms.problem);
        let linear = trial.linear();
        let mut loss = vec![0.0; count];
        for ((block, own), other) in block.iter().zip(residual).zip(&linear.residual) {
            loss[*block] += other * other - own * own;
        }
        let mean = loss.iter().sum::<f64>() / count as f64;
        let square: f64 = loss.iter().map(|l| (l - mean).powi(2)).sum();
        let scatter = (square / (count.max(2) - 1) as f64 / count as f64).sqrt();
        (mean < TIE_ERRORS * scatter).then(|| (order, linear.coefficients[term].clone()))
    };
    let free = |order: &f64| (bounds.min..=bounds.max).contains(order) && !found.contains(order);
    let way = |step: f64| (1..).map(move |k| found[shape] + step * f64::from(k)).take_while(free).map_while(other);
    let mut alike: Vec<(f64, Vec<f64>)> = way(-1.0).chain(way(1.0)).collect();
    alike.sort_by(|a, b| a.0.total_cmp(&b.0));
    alike
}
