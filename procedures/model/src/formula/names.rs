//! Resolution of names in a formula, with suggestions for unknown names.

use crate::formula::expression::{Expression, What};
use crate::formula::fault::Mistake;
use crate::formula::function::Function;
use crate::formula::signals::{COLUMN, NamedSignal, signals};
use crate::formula::syntax::{Node, Syntax};
use crate::signal::Signal;
use jointbench_instrument::Kind;
use jointbench_instrument::spelling::{instead, nearest};
use jointbench_instrument::units::unit_of;
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

    /// Zero for an unknown name.
    pub fn meaning(&mut self, name: &str, at: &Range<usize>) -> What {
        let parameter = self.parameters.iter().position(|p| *p == name).map(What::Parameter);
        parameter.or_else(|| signal_or_constant(name, self.kind)).unwrap_or_else(|| {
            // A repeated unknown name is the same error.
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
            match (unit_of(name), self.unknown.is_empty()) {
                (Some(_), _) => format!("write {COLUMN}({name}) if it is a column of the run, or {declare}"),
                (None, true) => format!(
                    "{declare}, or use a signal of {} runs: {}; another column of the run is {COLUMN}(its name)",
                    self.kind,
                    signals.join(", ")
                ),
                (None, false) => declare,
            }
        }
    }

    /// `column(oil_pressure_pa)`.
    pub fn column(&mut self, arguments: &[Node], at: &Range<usize>) -> What {
        let refused = match arguments {
            [Node { what: Syntax::Name(column), at }] => match self.column_signal(column) {
                Ok(signal) => return What::Signal(signal),
                Err(message) => Mistake::new(at.clone(), message),
            },
            _ => {
                let message =
                    format!("{COLUMN} takes the name of a column of the run, such as {COLUMN}(oil_pressure_pa)");
                Mistake::new(at.clone(), message)
            }
        };
        self.mistakes.push(refused);
        What::Number(0.0)
    }

    fn column_signal(&self, column: &str) -> Result<Signal, String> {
        if let Some(signal) = signals(self.kind).iter().find(|s| s.column == column) {
            return Ok(signal.signal);
        }
        if self.parameters.contains(&column) || signal_or_constant(column, self.kind).is_some() {
            return Err(format!("{column} is no column: write it without {COLUMN}( )"));
        }
        let known = self.kind.required_columns().iter().chain(self.kind.optional_columns());
        if known.into_iter().any(|known| *known == column) {
            return Err(format!("{column} is what the model is to predict, or counts its parts: it explains nothing"));
        }
        Ok(Signal::named(column))
    }

    /// `None` for an unknown function.
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

impl Expression {
    /// Resolves every name. Unknown names are errors, each name once.
    pub(crate) fn resolve(node: Node, kind: Kind, parameters: &[&str]) -> Result<Self, Mistake> {
        let mut names = Names::new(kind, parameters);
        let whole = Self::named(node, &mut names);
        Mistake::first_of(names.mistakes).map_or(Ok(whole), Err)
    }

    /// Unknown names become zero.
    fn named(node: Node, names: &mut Names) -> Self {
        let at = node.at;
        let mut inner = |node: Box<Node>| Box::new(Self::named(*node, names));
        let what = match node.what {
            Syntax::Number(value) => What::Number(value),
            Syntax::Name(name) => names.meaning(&name, &at),
            Syntax::Negate(a) => What::Negate(inner(a)),
            Syntax::Binary(operator, a, b) => What::Binary(operator, inner(a), inner(b)),
            Syntax::Call(name, arguments) if name == COLUMN => names.column(&arguments, &at),
            Syntax::Call(name, arguments) => {
                let given = arguments.len();
                let function = names.function(&name, given, &at);
                let arguments = arguments.into_iter().map(|a| Self::named(a, names)).collect();
                function.map_or(What::Number(0.0), |function| What::Call(function, arguments))
            }
        };
        Self { at, what }
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
    let names: Vec<&str> = Function::ALL.iter().map(|f| f.name()).chain([COLUMN]).collect();
    Mistake::new(at, format!("there is no function {name}; {}", instead(name, &names)))
}
