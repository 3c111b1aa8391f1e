//! Formulas of users: `tau = a * tanh(velocity / w0) * abs(load)`.
//!
//! Text is parsed to a tree (winnow), names become signals and parameters, and the tree becomes a sum of coefficients
//! times columns. Every error has a character position.

pub(crate) mod coefficients;
pub(crate) mod expression;
pub(crate) mod fault;
pub(crate) mod function;
pub(crate) mod names;
pub(crate) mod signals;
pub(crate) mod syntax;
pub(crate) mod units;

pub use crate::formula::expression::Expression;
pub(crate) use crate::formula::expression::{Value, What};
pub(crate) use crate::formula::fault::Mistake;
pub use crate::formula::fault::{FormulaFault, FurtherFault};
pub use crate::formula::function::Function;
pub use crate::formula::signals::{NamedSignal, in_formula, left_hand_side, signals};
pub(crate) use crate::formula::syntax::Operator;

use crate::signal::Signal;
use jointbench_instrument::{Kind, Motion};
use std::collections::BTreeSet;

/// A valid formula for a kind of run.
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    /// Linear parameters, by their place in the list, each with its regressor.
    pub columns: Vec<(usize, Expression)>,
    /// The nonlinear parameters.
    pub shape: Vec<usize>,
    /// Signals of the formula, in the order of the kind's table, and other columns.
    pub signals: Vec<NamedSignal>,
    /// Whether a sine or cosine of a signal occurs: its mean over an interval differs from its value at the middle.
    pub is_periodic: bool,
    /// Contradicting units for a rotating and for a sliding joint. They do not change results, so that the formula is
    /// still used.
    unit_faults: [Option<Mistake>; 2],
}

impl Formula {
    /// `units` are those of the parameters.
    pub(crate) fn parse(kind: Kind, text: &str, parameters: &[&str], units: &[&str]) -> Result<Self, Mistake> {
        let wanted = left_hand_side(kind);
        let tree = if is_bare(text, wanted, parameters) {
            syntax::right_hand_side(text)?
        } else {
            let ((left, at), tree) = syntax::equation(text)?;
            if left != wanted {
                return Err(Mistake::new(at, format!("a formula of {kind} runs begins with {wanted} =, not {left} =")));
            }
            tree
        };
        let whole = Expression::resolve(tree, kind, parameters)?;
        let coefficients = coefficients::coefficients(&whole, parameters.len());
        if let Some(alone) = coefficients.alone {
            let message = match coefficients.columns.is_empty() {
                true => "no parameter scales this: multiply it by one, such as k * (…)",
                false => "no parameter scales this part of the sum: multiply it by one",
            };
            return Err(Mistake::new(alone.at, message));
        }
        let linear = |p: &usize| coefficients.columns.iter().any(|(q, _)| q == p);
        let periodic = |what: &What| matches!(what, What::Call(f, a) if f.is_periodic() && a.iter().any(has_signal));
        let mut columns = BTreeSet::new();
        whole.any(&mut |what| {
            columns.extend(if let What::Signal(Signal::Column(column)) = what { Some(*column) } else { None });
            false
        });
        let columns = columns.into_iter().map(NamedSignal::of_column);
        Ok(Self {
            shape: (0..parameters.len()).filter(|p| !linear(p) && whole.uses(*p)).collect(),
            signals: signals(kind).iter().copied().filter(|s| whole.uses_signal(s.signal)).chain(columns).collect(),
            is_periodic: whole.any(&mut |what| periodic(what)),
            unit_faults: units::check(kind, text, &whole, units),
            columns: coefficients.columns,
        })
    }

    /// Contradicting units for this motion. If the motion is unknown, only contradictions for both.
    pub(crate) fn unit_fault(&self, motion: Option<Motion>) -> Option<&Mistake> {
        let [turning, sliding] = &self.unit_faults;
        match motion {
            Some(Motion::Rotary) => turning.as_ref(),
            Some(Motion::Linear) => sliding.as_ref(),
            None => turning.as_ref().filter(|_| sliding.is_some()),
        }
    }

    /// Whether the parameter occurs.
    pub fn uses(&self, parameter: usize) -> bool {
        self.shape.contains(&parameter) || self.columns.iter().any(|(p, _)| *p == parameter)
    }
}

/// Whether only the right-hand side was written, without ambiguity.
pub(crate) fn is_bare(text: &str, left: &str, parameters: &[&str]) -> bool {
    let begun = text.split(|c: char| !c.is_alphanumeric() && c != '_').find(|word| !word.is_empty());
    !text.contains('=') && !text.trim().is_empty() && (begun != Some(left) || parameters.contains(&left))
}

fn has_signal(e: &Expression) -> bool {
    e.any(&mut |what| matches!(what, What::Signal(_)))
}

#[cfg(test)]
mod tests;
