//! Linear parameters of a formula and their regressors.
//!
//! Separable least squares (Golub, Pereyra 2003) needs the model as Σ coefficient·column(nonlinear parameters). The
//! columns are derived from the formula, so that they need not be defined separately.

use crate::formula::expression::{Expression, What};
use crate::formula::syntax::Operator;

/// A sum of parameters times expressions without these parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LinearParts {
    /// Linear parameters, each with its regressor.
    pub columns: Vec<(usize, Expression)>,
    /// The part without a linear parameter.
    pub alone: Option<Expression>,
}

/// Finds the largest set of parameters in which the formula is linear; among equals the first in the order of the
/// list.
pub fn coefficients(formula: &Expression, parameters: usize) -> LinearParts {
    let mut sets: Vec<u32> = (0..1u32 << parameters).collect();
    sets.sort_by_key(|set| (std::cmp::Reverse(set.count_ones()), *set));
    // Every formula is linear in the empty set.
    let mut found = sets.into_iter().filter_map(|set| split(formula, set)).next().unwrap_or_default();
    found.columns.sort_by_key(|(parameter, _)| *parameter);
    found
}

/// The formula as a sum over the parameters of a set, if it is linear in them.
fn split(e: &Expression, set: u32) -> Option<LinearParts> {
    let is_coefficient = |what: &What| matches!(what, What::Parameter(p) if set & (1 << p) != 0);
    if !e.any(&mut |what| is_coefficient(what)) {
        return Some(LinearParts { columns: Vec::new(), alone: Some(e.clone()) });
    }
    let constant = |e: &Expression| !e.any(&mut |what| is_coefficient(what));
    match &e.what {
        What::Parameter(p) => {
            let one = Expression { at: e.at.clone(), what: What::Number(1.0) };
            Some(LinearParts { columns: vec![(*p, one)], alone: None })
        }
        What::Negate(a) => Some(split(a, set)?.map(negated)),
        What::Binary(Operator::Add, a, b) => Some(split(a, set)?.plus(split(b, set)?)),
        What::Binary(Operator::Subtract, a, b) => Some(split(a, set)?.plus(split(b, set)?.map(negated))),
        What::Binary(Operator::Multiply, a, b) if constant(a) => {
            Some(split(b, set)?.map(|x| joined(Operator::Multiply, (**a).clone(), x)))
        }
        What::Binary(operator @ (Operator::Multiply | Operator::Divide), a, b) if constant(b) => {
            Some(split(a, set)?.map(|x| joined(*operator, x, (**b).clone())))
        }
        _ => None,
    }
}

impl LinearParts {
    fn map(self, f: impl Fn(Expression) -> Expression) -> LinearParts {
        LinearParts { columns: self.columns.into_iter().map(|(p, e)| (p, f(e))).collect(), alone: self.alone.map(f) }
    }

    fn plus(mut self, other: LinearParts) -> LinearParts {
        self.alone = match (self.alone, other.alone) {
            (Some(a), Some(b)) => Some(joined(Operator::Add, a, b)),
            (a, b) => a.or(b),
        };
        for (parameter, e) in other.columns {
            match self.columns.iter().position(|(p, _)| *p == parameter) {
                Some(at) => {
                    let (_, first) = self.columns.remove(at);
                    self.columns.push((parameter, joined(Operator::Add, first, e)));
                }
                None => self.columns.push((parameter, e)),
            }
        }
        self
    }
}

fn negated(e: Expression) -> Expression {
    Expression { at: e.at.clone(), what: What::Negate(e.into()) }
}

fn joined(operator: Operator, a: Expression, b: Expression) -> Expression {
    let at = a.at.start.min(b.at.start)..a.at.end.max(b.at.end);
    Expression { at, what: What::Binary(operator, a.into(), b.into()) }
}
