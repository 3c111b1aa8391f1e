//! Formulas as C99.

use crate::formula::expression::{Expression, What};
use crate::formula::function::Function;
use crate::formula::syntax::Operator;
use crate::signal::Signal;

/// The expression with every signal and parameter under its name in C.
pub fn c(e: &Expression, signal: &dyn Fn(Signal) -> String, parameter: &dyn Fn(usize) -> String) -> String {
    let of = |e: &Expression| c(e, signal, parameter);
    match &e.what {
        What::Number(value) => number(*value),
        What::Signal(s) => signal(*s),
        What::Parameter(p) => parameter(*p),
        What::Negate(a) => format!("(-{})", of(a)),
        What::Binary(Operator::Power, a, b) => format!("pow({}, {})", of(a), of(b)),
        What::Binary(operator, a, b) => {
            let sign = match operator {
                Operator::Add => '+',
                Operator::Subtract => '-',
                Operator::Multiply => '*',
                Operator::Divide | Operator::Power => '/',
            };
            format!("({} {sign} {})", of(a), of(b))
        }
        What::Call(Function::Sign, arguments) => {
            let x = arguments.first().map(of).unwrap_or_default();
            format!("(double)(({x} > 0.0) - ({x} < 0.0))")
        }
        What::Call(Function::Wrap, arguments) => {
            let x = arguments.first().map(of).unwrap_or_default();
            format!("remainder({x}, {})", number(std::f64::consts::TAU))
        }
        What::Call(function, arguments) => {
            format!("{}({})", function.c_name(), arguments.iter().map(of).collect::<Vec<_>>().join(", "))
        }
    }
}

/// A literal that is read back as the same bits.
pub fn number(value: f64) -> String {
    format!("{value:e}")
}
