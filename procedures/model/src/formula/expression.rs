//! A formula whose names are all known: evaluated over whole columns at once.

use super::fault::Mistake;
use super::function::Function;
use super::signals::{NamedSignal, signals};
use super::syntax::{Node, Operator, Syntax};
use crate::view::{Signal, Signals};
use jointbench_instrument::Kind;
use std::borrow::Cow;
use std::ops::Range;

#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    /// Bytes of the formula.
    pub at: Range<usize>,
    pub what: What,
}

#[derive(Debug, Clone, PartialEq)]
pub enum What {
    Number(f64),
    Signal(Signal),
    /// Which of the effect's parameters.
    Parameter(usize),
    Negate(Box<Expression>),
    Binary(Operator, Box<Expression>, Box<Expression>),
    Call(Function, Vec<Expression>),
}

impl Expression {
    /// Gives every name its meaning. The first that has none is the mistake.
    pub(crate) fn resolve(node: Node, kind: Kind, parameters: &[&str]) -> Result<Self, Mistake> {
        let at = node.at;
        let inner = |node: Box<Node>| Ok(Box::new(Self::resolve(*node, kind, parameters)?));
        let what = match node.what {
            Syntax::Number(value) => What::Number(value),
            Syntax::Name(name) => match parameters.iter().position(|p| *p == name) {
                Some(parameter) => What::Parameter(parameter),
                None => signal_or_constant(&name, kind).ok_or_else(|| unknown(&name, at.clone(), kind, parameters))?,
            },
            Syntax::Negate(a) => What::Negate(inner(a)?),
            Syntax::Binary(operator, a, b) => What::Binary(operator, inner(a)?, inner(b)?),
            Syntax::Call(name, arguments) => {
                let function = Function::find(&name).ok_or_else(|| no_function(&name, at.start))?;
                if arguments.len() != function.arity() {
                    let (wanted, given) = (function.arity(), arguments.len());
                    let plural = if wanted == 1 { "" } else { "s" };
                    return Err(Mistake::new(at, format!("{name} takes {wanted} argument{plural}, not {given}")));
                }
                let arguments = arguments.into_iter().map(|a| Self::resolve(a, kind, parameters));
                What::Call(function, arguments.collect::<Result<_, _>>()?)
            }
        };
        Ok(Self { at, what })
    }

    /// The value of every row.
    pub fn column(&self, parameters: &[f64], signals: &Signals) -> Vec<f64> {
        match self.value(parameters, signals) {
            Value::One(value) => vec![value; signals.len()],
            Value::Many(values) => values.into_owned(),
        }
    }

    fn value<'s>(&self, parameters: &[f64], signals: &'s Signals) -> Value<'s> {
        let of = |expression: &Expression| expression.value(parameters, signals);
        match &self.what {
            What::Number(value) => Value::One(*value),
            What::Parameter(parameter) => Value::One(parameters[*parameter]),
            // A signal that is not there is asked for by nobody: the effect is not visible.
            What::Signal(signal) => signals.find(*signal).map_or(Value::One(f64::NAN), |v| Value::Many(v.into())),
            What::Negate(a) => of(a).map(|x| -x),
            What::Binary(operator, a, b) => match operator {
                Operator::Add => of(a).with(of(b), |x, y| x + y),
                Operator::Subtract => of(a).with(of(b), |x, y| x - y),
                Operator::Multiply => of(a).with(of(b), |x, y| x * y),
                Operator::Divide => of(a).with(of(b), |x, y| x / y),
                Operator::Power => of(a).with(of(b), f64::powf),
            },
            What::Call(function, arguments) => match arguments.as_slice() {
                [x, y] => of(x).with(of(y), |x, y| function.apply(x, y)),
                [x, ..] => of(x).map(|x| function.apply(x, 0.0)),
                [] => Value::One(f64::NAN),
            },
        }
    }

    /// Whether any part of the expression is such.
    pub fn any(&self, such: &mut impl FnMut(&What) -> bool) -> bool {
        such(&self.what)
            || match &self.what {
                What::Number(_) | What::Signal(_) | What::Parameter(_) => false,
                What::Negate(a) => a.any(such),
                What::Binary(_, a, b) => a.any(such) || b.any(such),
                What::Call(_, arguments) => arguments.iter().any(|a| a.any(such)),
            }
    }

    pub fn uses(&self, parameter: usize) -> bool {
        self.any(&mut |what| *what == What::Parameter(parameter))
    }

    pub fn uses_signal(&self, signal: Signal) -> bool {
        self.any(&mut |what| *what == What::Signal(signal))
    }

    /// The same with parameters under other numbers.
    pub fn renumbered(&self, number: &dyn Fn(usize) -> usize) -> Self {
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
enum Value<'s> {
    One(f64),
    Many(Cow<'s, [f64]>),
}

impl<'s> Value<'s> {
    fn map(self, f: impl Fn(f64) -> f64) -> Value<'s> {
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

fn signal_or_constant(name: &str, kind: Kind) -> Option<What> {
    if name == "pi" {
        return Some(What::Number(std::f64::consts::PI));
    }
    signals(kind).iter().find(|s| s.name == name).map(|s| What::Signal(s.signal))
}

fn unknown(name: &str, at: Range<usize>, kind: Kind, parameters: &[&str]) -> Mistake {
    let names = || signals(kind).iter().map(|s| s.name);
    let by_column: Option<&NamedSignal> = signals(kind).iter().find(|s| s.column == name);
    let hint = if let Some(signal) = by_column {
        format!("write {} ({})", signal.name, signal.meaning)
    } else if Function::find(name).is_some() {
        format!("{name} is a function: write its arguments in brackets")
    } else if let Some(near) = names().chain(parameters.iter().copied()).find(|known| is_near(name, known)) {
        format!("did you mean {near}?")
    } else {
        let signals: Vec<&str> = names().collect();
        format!("declare it as a parameter, or use a signal of {kind} runs: {}", signals.join(", "))
    };
    Mistake::new(at, format!("{name} is neither a signal nor a parameter of this effect; {hint}"))
}

fn no_function(name: &str, start: usize) -> Mistake {
    let at = start..start + name.len();
    let names: Vec<&str> = Function::ALL.iter().map(|f| f.name()).collect();
    let hint = match names.iter().find(|known| is_near(name, known)) {
        Some(near) => format!("did you mean {near}?"),
        None => format!("there are {}", names.join(", ")),
    };
    Mistake::new(at, format!("there is no function {name}; {hint}"))
}

/// One letter wrong, missing, too many, or two in the wrong order.
fn is_near(a: &str, b: &str) -> bool {
    let (a, b): (Vec<char>, Vec<char>) = (a.to_lowercase().chars().collect(), b.to_lowercase().chars().collect());
    let head = a.iter().zip(&b).take_while(|(a, b)| a == b).count();
    let tail = a[head..].iter().rev().zip(b[head..].iter().rev()).take_while(|(a, b)| a == b).count();
    let (left_a, left_b) = (&a[head..a.len() - tail], &b[head..b.len() - tail]);
    let swapped = left_a.len() == 2 && left_b.len() == 2 && left_a[0] == left_b[1] && left_a[1] == left_b[0];
    a.len().max(b.len()) > 2 && (swapped || left_a.len().max(left_b.len()) <= 1)
}
