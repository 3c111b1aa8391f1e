//! Parameters with intervals that survive autocorrelation: a jackknife over blocks.

use crate::effect::{Search, Shape};
use crate::linear::{BlockGrams, Spd};
use crate::report::{Parameter, ParameterState, TradeOff};
use crate::terms::Terms;
use jointbench_instrument::Motion;
use statrs::distribution::{ContinuousCDF, StudentsT};

pub struct Intervals {
    pub parameters: Vec<Parameter>,
    pub trade_offs: Vec<TradeOff>,
}

/// Two parameters whose estimates are correlated more than this are one combination that the data decides.
const TRADE_OFF: f64 = 0.95;

struct Slot<'a> {
    effect: &'a str,
    name: &'a str,
    value: f64,
    /// `None` for a factor.
    shape: Option<Shape<'a>>,
}

/// Parameters of the terms with 95 % intervals: delete-one-block jackknife of the linearised model, Student's t with
/// G − 1 degrees of freedom.
pub fn intervals(terms: &Terms, motion: Motion) -> Intervals {
    let linear = terms.linear();
    let slopes = terms.slopes(&linear.factors);
    let mut columns = terms.columns();
    let mut slots: Vec<Slot> = Vec::new();
    for (term, factors) in terms.terms.iter().zip(&linear.factors) {
        for (name, value) in term.form.linear.iter().zip(factors) {
            slots.push(Slot { effect: term.id(), name, value: *value, shape: None });
        }
    }
    for (i, k, slope) in &slopes {
        let (term, shape) = (&terms.terms[*i], terms.terms[*i].form.shape[*k]);
        columns.push(slope);
        slots.push(Slot { effect: term.id(), name: shape.name, value: term.shape[*k], shape: Some(shape) });
    }
    let p = columns.len();
    let grams = BlockGrams::new(&columns, &linear.residual, &terms.problem.block, terms.problem.blocks);
    let (gram, _) = grams.total();
    let spd = Spd::new(&gram, p, 0.0);
    let leave: Vec<Vec<f64>> = grams.jackknife();
    let groups = leave.len().max(2) as f64;
    let covariance = |a: usize, b: usize| {
        let mean = |k: usize| leave.iter().map(|l| l[k]).sum::<f64>() / groups;
        let (ma, mb) = (mean(a), mean(b));
        (groups - 1.0) / groups * leave.iter().map(|l| (l[a] - ma) * (l[b] - mb)).sum::<f64>()
    };
    let t = StudentsT::new(0.0, 1.0, groups - 1.0).map_or(2.0, |t| t.inverse_cdf(0.975));
    let mut parameters = Vec::new();
    for (k, slot) in slots.iter().enumerate() {
        let reach = t * covariance(k, k).sqrt();
        let ci95 = match slot.shape {
            Some(shape) => [-reach, reach].map(|step| shape.moved(slot.value, step.clamp(-50.0, 50.0))),
            None => [slot.value - reach, slot.value + reach],
        };
        let info = terms.terms.iter().find(|t| t.id() == slot.effect).map(|t| t.effect.info());
        let unit = info.map_or("1", |i| i.unit(slot.name));
        let (state, note) = judge(slot, ci95, spd.is_dead(k));
        let (effect, name) = (slot.effect.to_owned(), slot.name.to_owned());
        parameters.push(Parameter { effect, name, value: slot.value, unit: motion.label(unit), ci95, state, note });
    }
    for term in &terms.terms {
        for (shape, value) in term.form.shape.iter().zip(&term.shape).filter(|(s, _)| !s.is_smooth()) {
            let unit = term.effect.info().unit(shape.name);
            parameters.push(Parameter {
                effect: term.id().into(),
                name: shape.name.into(),
                value: *value,
                unit: motion.label(unit),
                ci95: [*value, *value],
                state: ParameterState::Ok,
                note: None,
            });
        }
    }
    let mut trade_offs = Vec::new();
    for a in 0..p {
        for b in 0..a {
            let scale = (covariance(a, a) * covariance(b, b)).sqrt();
            let correlation = if scale > 0.0 { covariance(a, b) / scale } else { 0.0 };
            if correlation.abs() > TRADE_OFF {
                let name = |k: usize| format!("{}.{}", slots[k].effect, slots[k].name);
                trade_offs.push(TradeOff { first: name(b), second: name(a), correlation });
            }
        }
    }
    Intervals { parameters, trade_offs }
}

fn judge(slot: &Slot, ci95: [f64; 2], dead: bool) -> (ParameterState, Option<String>) {
    if dead {
        return (ParameterState::Unidentified, Some("this data says nothing about it".into()));
    }
    if let Some(shape) = slot.shape {
        let edge = |bound: f64| (slot.value - bound).abs() <= 1e-3 * bound.abs().max(1e-3 * (shape.max - shape.min));
        if edge(shape.min) || edge(shape.max) {
            let words = "the best value lies at the edge of what this data can speak about";
            return (ParameterState::AtBound, Some(words.into()));
        }
        if shape.search == Search::Smooth && ci95[1] > 10.0 * ci95[0].abs() {
            let words = format!("hardly identified: anything from {:.3} to {:.3} fits", ci95[0], ci95[1]);
            return (ParameterState::Unidentified, Some(words));
        }
    }
    if slot.shape.is_none() && ci95[0] < 0.0 && ci95[1] > 0.0 {
        return (ParameterState::Unidentified, Some("the interval holds zero".into()));
    }
    (ParameterState::Ok, None)
}
