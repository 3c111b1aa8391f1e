//! Parameters with intervals that are robust against autocorrelation and segment scatter, by a jackknife over
//! independent blocks.

use crate::inference::block_intervals;
use crate::inference::harmonic_order::Explained;
use crate::inference::parameter_state::{Intervals, Slot};
use crate::inference::{changepoint, drag_remanence, harmonic_order, parameter_state};
use crate::stats::{jackknife, student};
use crate::thresholds::TRADE_OFF_CORRELATION;

use crate::effect::ShapeSearch;
use crate::linear::cholesky::Cholesky;
use crate::linear::gram::BlockGrams;
use crate::preprocess::independent_blocks::independent_blocks;
use crate::regression::linear_model::{LinearModel, Term};
use crate::report::fit::{Parameter, ParameterState, TradeOff};
use jointbench_instrument::Motion;

/// Parameters of the terms with 95 % intervals.
///
/// Delete-one-block jackknife of the linearised model about the full estimate (CV3 of MacKinnon, Nielsen, Webb 2023).
/// Student's t uses the effective number of blocks of each parameter: only the few slowest segments determine a
/// Stribeck speed, independent of the number of fast ones (Carter, Schnepel, Steigerwald 2017).
pub fn intervals(terms: &LinearModel, motion: Motion) -> Intervals {
    if let Some(found) = block_intervals::intervals(terms, motion) {
        return found;
    }
    let linear = terms.linear();
    let slopes = terms.slopes(&linear.coefficients);
    let mut columns = terms.columns();
    columns.extend(slopes.iter().map(|s| s.2.as_slice()));
    let slots = slots(terms, &linear.coefficients, &slopes, motion);
    let p = columns.len();
    let (block, count) = independent_blocks(terms.problem, p);
    let grams = BlockGrams::new(&columns, &linear.residual, &block, count);
    let spd = Cholesky::new(&grams.total().0, p, 0.0);
    let replicates = grams.jackknife();
    let groups = replicates.len().max(2) as f64;
    // The replicates are steps from the full estimate, because the Gram matrices are built with the residual.
    let covariance = |a: usize, b: usize| jackknife::variance(replicates.iter().map(|r| r[a] * r[b]), groups);
    let variance: Vec<f64> = (0..p).map(|k| covariance(k, k)).collect();
    let effective_blocks = grams.effective_groups(&spd);
    let mut parameters = Vec::new();
    for (k, slot) in slots.iter().enumerate() {
        let freedom = (effective_blocks[k] - 1.0).max(1.0);
        let t = student::half_width_95(freedom);
        let reach = if spd.is_dependent(k) { f64::INFINITY } else { t * variance[k].sqrt() };
        let ci95 = match slot.shape {
            Some(shape) => [
                shape.stepped(slot.value, (-reach).max(-50.0)).max(shape.min.min(slot.value)),
                shape.stepped(slot.value, reach.min(50.0)).min(shape.max.max(slot.value)),
            ],
            None => [slot.value - reach, slot.value + reach],
        };
        let (state, note) = parameter_state::judge(slot, ci95, spd.is_dependent(k));
        parameters.push(Parameter {
            effect: slot.effect.into(),
            name: slot.name.into(),
            value: slot.value,
            unit: slot.unit.clone(),
            ci95,
            state,
            note,
        });
    }
    parameter_state::know_the_small(&mut parameters);
    parameters.extend(found(terms, &linear.residual, motion));
    harmonic_order::open(terms, &mut parameters, |term, k| of_order(terms, term, k, &block, count));
    drag_remanence::open(terms, &mut parameters);
    let mut trade_offs = Vec::new();
    for a in 0..p {
        for b in 0..a {
            let scale = (variance[a] * variance[b]).sqrt();
            let correlation = if scale > 0.0 { covariance(a, b) / scale } else { 0.0 };
            if correlation.abs() > TRADE_OFF_CORRELATION {
                let name = |k: usize| format!("{}.{}", slots[k].effect, slots[k].name);
                trade_offs.push(TradeOff { first: name(b), second: name(a), correlation });
            }
        }
    }
    Intervals { parameters, trade_offs }
}

fn slots<'a>(
    terms: &'a LinearModel,
    coefficients: &[Vec<f64>],
    slopes: &[(usize, usize, Vec<f64>)],
    motion: Motion,
) -> Vec<Slot<'a>> {
    let slot = |term: usize, name: &'a str, value, shape| {
        let info = terms.terms[term].effect.info();
        let known = info.parameters.iter().find(|p| p.name == name);
        let possible = known.map_or((f64::NEG_INFINITY, f64::INFINITY), |p| (p.min, p.max));
        Slot { effect: info.id, name, unit: motion.label(info.unit(name)), value, possible, shape }
    };
    let mut slots = Vec::new();
    for (i, coefficients) in coefficients.iter().enumerate() {
        let names = &terms.terms[i].form.linear;
        slots.extend(names.iter().zip(coefficients).map(|(name, value)| slot(i, name, *value, None)));
    }
    for (i, k, _) in slopes {
        let shape = terms.terms[*i].form.shape[*k];
        slots.push(slot(*i, shape.name, terms.terms[*i].shape[*k], Some(shape)));
    }
    slots
}

/// The errors of the independent blocks and the coefficients of a term as functions of an order of its waves.
fn of_order(terms: &LinearModel, term: usize, k: usize, block: &[usize], count: usize) -> impl Fn(f64) -> Explained {
    let Term { effect, form, shape, .. } = &terms.terms[term];
    move |order| {
        let mut orders = shape.clone();
        orders[k] = order;
        let mut trial = terms.clone();
        trial.terms[term] = Term::new(*effect, form.clone(), orders, terms.problem);
        let mut linear = trial.linear();
        let mut losses = vec![0.0; count];
        for (block, error) in block.iter().zip(&linear.residual) {
            losses[*block] += error * error;
        }
        Explained { losses, coefficients: linear.coefficients.swap_remove(term).into_iter().enumerate().collect() }
    }
}

/// Integer parameters as found, and changepoints with their intervals.
fn found(terms: &LinearModel, residual: &[f64], motion: Motion) -> Vec<Parameter> {
    let mut out = Vec::new();
    for (i, term) in terms.terms.iter().enumerate() {
        for (k, shape) in term.form.shape.iter().enumerate().filter(|(_, s)| !s.is_smooth()) {
            let value = term.shape[k];
            let jump = shape.search == ShapeSearch::Jump;
            let is_known = shape.min == shape.max;
            out.push(Parameter {
                effect: term.id().into(),
                name: shape.name.into(),
                value,
                unit: motion.label(term.effect.info().unit(shape.name)),
                ci95: if jump { changepoint::interval(terms, residual, i, k) } else { [value, value] },
                state: if is_known { ParameterState::Fixed } else { ParameterState::Ok },
                note: None,
            });
        }
    }
    out
}
