//! A formula with resolved names, evaluated over whole columns.

use crate::formula::function::Function;
use crate::formula::syntax::Operator;
use crate::signal::{Signal, Signals};
use std::borrow::Cow;
use std::ops::Range;

/// A part of a formula, with its position in the text. Opaque outside of this crate.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    /// Byte range in the formula.
    pub(crate) at: Range<usize>,
    pub(crate) what: What,
}

#[derive(Debug, Clone, PartialEq)]
pub enum What {
    Number(f64),
    Signal(Signal),
    /// Index of the effect's parameter.
    Parameter(usize),
    Negate(Box<Expression>),
    Binary(Operator, Box<Expression>, Box<Expression>),
    Call(Function, Vec<Expression>),
}

impl Expression {
    /// The value of every row.
    pub(crate) fn column(&self, parameters: &[f64], signals: &Signals) -> Vec<f64> {
        self.value(parameters, signals).of_rows(signals.len())
    }

    fn value<'s>(&self, parameters: &[f64], signals: &'s Signals) -> Value<'s> {
        let of = |expression: &Expression| expression.value(parameters, signals);
        match &self.what {
            What::Number(value) => Value::One(*value),
            What::Parameter(parameter) => Value::One(parameters[*parameter]),
            // A missing signal is never evaluated, because its effect is not visible.
            What::Signal(signal) => signals.find(*signal).map_or(Value::One(f64::NAN), |v| Value::Many(v.into())),
            What::Negate(a) => of(a).map(|x| -x),
            What::Binary(operator, a, b) => of(a).operated(*operator, of(b)),
            What::Call(function, arguments) => Value::called(*function, arguments.iter().map(of).collect()),
        }
    }

    /// Whether any part of the expression satisfies `such`.
    pub(crate) fn any(&self, such: &mut impl FnMut(&What) -> bool) -> bool {
        such(&self.what)
            || match &self.what {
                What::Number(_) | What::Signal(_) | What::Parameter(_) => false,
                What::Negate(a) => a.any(such),
                What::Binary(_, a, b) => a.any(such) || b.any(such),
                What::Call(_, arguments) => arguments.iter().any(|a| a.any(such)),
            }
    }

    pub(crate) fn uses(&self, parameter: usize) -> bool {
        self.any(&mut |what| *what == What::Parameter(parameter))
    }

    pub(crate) fn uses_signal(&self, signal: Signal) -> bool {
        self.any(&mut |what| *what == What::Signal(signal))
    }

    /// First occurrence of a signal.
    pub(crate) fn place_of(&self, signal: Signal) -> Option<Range<usize>> {
        match &self.what {
            What::Number(_) | What::Parameter(_) => None,
            What::Signal(own) => (*own == signal).then(|| self.at.clone()),
            What::Negate(a) => a.place_of(signal),
            What::Binary(_, a, b) => a.place_of(signal).or_else(|| b.place_of(signal)),
            What::Call(_, arguments) => arguments.iter().find_map(|a| a.place_of(signal)),
        }
    }

    /// The expression with other parameter numbers.
    pub(crate) fn renumbered(&self, number: &dyn Fn(usize) -> usize) -> Self {
        let of = |e: &Expression| e.renumbered(number);
        let what = match &self.what {
            What::Number(value) => What::Number(*value),
            What::Signal(signal) => What::Signal(*signal),
            What::Parameter(parameter) => What::Parameter(number(*parameter)),
            What::Negate(a) => What::Negate(of(a).into()),
            What::Binary(operator, a, b) => What::Binary(*operator, of(a).into(), of(b).into()),
            What::Call(function, arguments) => What::Call(*function, arguments.iter().map(of).collect()),
        };
        Self { at: self.at.clone(), what }
    }
}

/// One value for all rows, or one for each.
pub(crate) enum Value<'s> {
    One(f64),
    Many(Cow<'s, [f64]>),
}

impl<'s> Value<'s> {
    /// The value of each of `len` rows.
    pub fn of_rows(self, len: usize) -> Vec<f64> {
        match self {
            Value::One(value) => vec![value; len],
            Value::Many(values) => values.into_owned(),
        }
    }

    pub fn operated(self, operator: Operator, other: Value<'s>) -> Value<'s> {
        match operator {
            Operator::Add => self.with(other, |x, y| x + y),
            Operator::Subtract => self.with(other, |x, y| x - y),
            Operator::Multiply => self.with(other, |x, y| x * y),
            Operator::Divide => self.with(other, |x, y| x / y),
            Operator::Power => self.with(other, f64::powf),
        }
    }

    /// NaN for a function without arguments, which no formula contains.
    pub fn called(function: Function, arguments: Vec<Value<'s>>) -> Value<'s> {
        let mut arguments = arguments.into_iter();
        match (arguments.next(), arguments.next()) {
            (Some(x), Some(y)) => x.with(y, |x, y| function.apply(x, y)),
            (Some(x), None) => x.map(|x| function.apply(x, 0.0)),
            (None, _) => Value::One(f64::NAN),
        }
    }

    pub fn map(self, f: impl Fn(f64) -> f64) -> Value<'s> {
        match self {
            Value::One(x) => Value::One(f(x)),
            Value::Many(values) => {
                let mut values = values.into_owned();
                values.iter_mut().for_each(|x| *x = f(*x));
                Value::Many(values.into())
            }
        }
    }

    fn with(self, other: Value<'s>, f: impl Fn(f64, f64) -> f64) -> Value<'s> {
        match (self, other) {
            (a, Value::One(y)) => a.map(|x| f(x, y)),
            (Value::One(x), b) => b.map(|y| f(x, y)),
            (Value::Many(a), Value::Many(b)) => {
                let mut a = a.into_owned();
                a.iter_mut().zip(b.iter()).for_each(|(x, y)| *x = f(*x, *y));
                Value::Many(a.into())
            }
        }
    }
}
