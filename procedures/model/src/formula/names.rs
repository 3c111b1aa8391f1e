//! What the names of a formula mean, and what to write instead of those that mean nothing.

use super::expression::What;
use super::fault::Mistake;
use super::function::Function;
use super::signals::{NamedSignal, signals};
use jointbench_instrument::Kind;
use jointbench_instrument::spelling::{instead, nearest};
use std::ops::Range;

pub struct Names<'n> {
    kind: Kind,
    parameters: &'n [&'n str],
    unknown: Vec<String>,
    pub mistakes: Vec<Mistake>,
}

impl<'n> Names<'n> {
    pub fn new(kind: Kind, parameters: &'n [&'n str]) -> Self {
        Self { kind, parameters, unknown: Vec::new(), mistakes: Vec::new() }
    }

    /// Zero where a name means nothing.
    pub fn meaning(&mut self, name: &str, at: &Range<usize>) -> What {
        let parameter = self.parameters.iter().position(|p| *p == name).map(What::Parameter);
        parameter.or_else(|| signal_or_constant(name, self.kind)).unwrap_or_else(|| {
            // A name that stands there again is the same mistake.
            if !self.unknown.iter().any(|known| known == name) {
                let hint = self.hint(name);
                let message = format!("{name} is neither a signal nor a parameter of this effect; {hint}");
                self.mistakes.push(Mistake::new(at.clone(), message));
                self.unknown.push(name.to_owned());
            }
            What::Number(0.0)
        })
    }

    fn hint(&self, name: &str) -> String {
        let known = || signals(self.kind).iter().map(|s| s.name);
        let by_column: Option<&NamedSignal> = signals(self.kind).iter().find(|s| s.column == name);
        if let Some(signal) = by_column {
            format!("write {} ({})", signal.name, signal.meaning)
        } else if Function::find(name).is_some() {
            format!("{name} is a function: write its arguments in brackets")
        } else if let Some(near) = nearest(name, known().chain(self.parameters.iter().copied())) {
            format!("did you mean {near}?")
        } else {
            let declare = format!("declare it as a parameter with its unit and range, such as `{name} [Nm] 0..1`");
            let signals: Vec<&str> = known().collect();
            match self.unknown.is_empty() {
                true => format!("{declare}, or use a signal of {} runs: {}", self.kind, signals.join(", ")),
                false => declare,
            }
        }
    }

    /// `None` where there is no such function.
    pub fn function(&mut self, name: &str, given: usize, at: &Range<usize>) -> Option<Function> {
        let Some(function) = Function::find(name) else {
            self.mistakes.push(no_function(name, at.start));
            return None;
        };
        let wanted = function.arity();
        if given != wanted {
            let plural = if wanted == 1 { "" } else { "s" };
            let message = format!("{name} takes {wanted} argument{plural}, not {given}");
            self.mistakes.push(Mistake::new(at.clone(), message));
        }
        Some(function)
    }
}

fn signal_or_constant(name: &str, kind: Kind) -> Option<What> {
    if name == "pi" {
        return Some(What::Number(std::f64::consts::PI));
    }
    signals(kind).iter().find(|s| s.name == name).map(|s| What::Signal(s.signal))
}

fn no_function(name: &str, start: usize) -> Mistake {
    let at = start..start + name.len();
    let names: Vec<&str> = Function::ALL.iter().map(|f| f.name()).collect();
    Mistake::new(at, format!("there is no function {name}; {}", instead(name, &names)))
}
