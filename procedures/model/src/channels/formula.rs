//! A formula over the columns of a run: `motor_current_a * 0.064 - derivative(motor_velocity_rad_s) * 1.2e-5`.
//!
//! The language is that of effects, without parameters: a name is a column of the run. Three functions operate over
//! time.

use super::over_time;
use crate::formula::syntax::{self, Node, Syntax};
use crate::formula::{FormulaFault, Function, Mistake, Operator, Value};
use jointbench_instrument::spelling::instead;
use jointbench_instrument::units::unit_of;
use std::ops::Range;

const TIME: &str = "time_s";
/// Function name for a column in formulas of effects; here the column name alone is sufficient.
const COLUMN: &str = "column";

/// Functions of a column over the neighbouring rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OverTime {
    /// Derivative with respect to time.
    Derivative,
    /// Integral over time from the first row on.
    Integral,
    /// Mean over this number of seconds, centred on each row.
    Smooth,
}

impl OverTime {
    /// Every function over time.
    pub const ALL: [OverTime; 3] = [OverTime::Derivative, OverTime::Integral, OverTime::Smooth];

    /// Function name in a formula.
    pub fn name(self) -> &'static str {
        match self {
            OverTime::Derivative => "derivative",
            OverTime::Integral => "integral",
            OverTime::Smooth => "smooth",
        }
    }

    fn arity(self) -> usize {
        if self == OverTime::Smooth { 2 } else { 1 }
    }
}

/// A formula whose names are all columns of the run.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelFormula {
    text: String,
    columns: Vec<String>,
    whole: Part,
}

#[derive(Debug, Clone, PartialEq)]
enum Part {
    Number(f64),
    /// Index of the column in the list of the formula.
    Column(usize),
    Negate(Box<Part>),
    Binary(Operator, Box<Part>, Box<Part>),
    Call(Function, Vec<Part>),
    /// With the seconds of `smooth`.
    Over(OverTime, Box<Part>, f64),
}

impl ChannelFormula {
    /// `known` are the columns of the run.
    ///
    /// # Errors
    /// The first error, at its character, with all other errors of the same text.
    pub fn parse(text: &str, known: &[&str]) -> Result<Self, FormulaFault> {
        let found = |mistake: Mistake| mistake.found("", "formula", text);
        let tree = syntax::right_hand_side(text).map_err(found)?;
        let mut names = Names { known, columns: Vec::new(), mistakes: Vec::new() };
        let whole = names.part(&tree);
        match Mistake::first_of(names.mistakes) {
            Some(mistake) => Err(found(mistake)),
            None => Ok(Self { text: text.trim().to_owned(), columns: names.columns, whole }),
        }
    }

    /// The original text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The columns of the formula, each once.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The unit of a column, its derivative, integral or mean. `None` for a combination of several columns.
    pub fn unit(&self) -> Option<String> {
        self.unit_of(&self.whole)
    }

    fn unit_of(&self, part: &Part) -> Option<String> {
        match part {
            Part::Column(column) => unit_of(&self.columns[*column]).map(str::to_owned),
            Part::Negate(a) | Part::Over(OverTime::Smooth, a, _) => self.unit_of(a),
            Part::Over(OverTime::Derivative, a, _) => self.unit_of(a).map(|unit| per_second(&unit)),
            Part::Over(OverTime::Integral, a, _) => self.unit_of(a).map(|unit| in_seconds(&unit)),
            Part::Call(Function::Abs, arguments) => self.unit_of(&arguments[0]),
            Part::Number(_) | Part::Binary(..) | Part::Call(..) => None,
        }
    }

    /// The value of every row. `columns` are those of [`Self::columns`], each as long as `time_s`.
    pub fn values(&self, time_s: &[f64], columns: &[&[f64]]) -> Vec<f64> {
        value(&self.whole, time_s, columns).of_rows(time_s.len())
    }
}

fn value<'c>(part: &Part, time_s: &[f64], columns: &[&'c [f64]]) -> Value<'c> {
    let of = |part: &Part| value(part, time_s, columns);
    match part {
        Part::Number(number) => Value::One(*number),
        Part::Column(column) => Value::Many(columns[*column].into()),
        Part::Negate(a) => of(a).map(|x| -x),
        Part::Binary(operator, a, b) => of(a).operated(*operator, of(b)),
        Part::Call(function, arguments) => Value::called(*function, arguments.iter().map(of).collect()),
        Part::Over(over, a, seconds) => {
            let values = of(a).of_rows(time_s.len());
            let values = match over {
                OverTime::Derivative => over_time::derivative(time_s, &values),
                OverTime::Integral => over_time::integral(time_s, &values),
                OverTime::Smooth => over_time::smooth(time_s, &values, *seconds),
            };
            Value::Many(values.into())
        }
    }
}

fn per_second(unit: &str) -> String {
    match unit {
        "rad/s" | "m/s" => format!("{unit}²"),
        _ => format!("{unit}/s"),
    }
}

fn in_seconds(unit: &str) -> String {
    match unit.strip_suffix("/s") {
        Some(whole) => whole.to_owned(),
        None => format!("{unit}·s"),
    }
}

/// Resolves every name. An unknown name is an error and evaluates to zero.
struct Names<'k> {
    known: &'k [&'k str],
    columns: Vec<String>,
    mistakes: Vec<Mistake>,
}

impl Names<'_> {
    fn part(&mut self, node: &Node) -> Part {
        match &node.what {
            Syntax::Number(number) => Part::Number(*number),
            Syntax::Name(name) => self.name(name, &node.at),
            Syntax::Negate(a) => Part::Negate(self.part(a).into()),
            Syntax::Binary(operator, a, b) => Part::Binary(*operator, self.part(a).into(), self.part(b).into()),
            Syntax::Call(name, arguments) => match (name.as_str(), arguments.as_slice()) {
                (COLUMN, [Node { what: Syntax::Name(column), at }]) => self.name(column, at),
                _ => self.call(name, arguments, &node.at),
            },
        }
    }

    fn name(&mut self, name: &str, at: &Range<usize>) -> Part {
        let name = if name == "time" { TIME } else { name };
        if name == "pi" {
            return Part::Number(std::f64::consts::PI);
        }
        if !self.known.contains(&name) {
            return self.refuse(at, format!("{name} is no column of the run; {}", instead(name, self.known)));
        }
        let place = self.columns.iter().position(|column| column == name);
        Part::Column(place.unwrap_or_else(|| {
            self.columns.push(name.to_owned());
            self.columns.len() - 1
        }))
    }

    fn call(&mut self, name: &str, arguments: &[Node], at: &Range<usize>) -> Part {
        let over = OverTime::ALL.into_iter().find(|over| over.name() == name);
        let function = Function::find(name);
        let Some(wanted) = over.map(OverTime::arity).or(function.map(Function::arity)) else {
            let known = Function::ALL.iter().map(|f| f.name()).chain(OverTime::ALL.map(OverTime::name));
            let known: Vec<&str> = known.collect();
            let place = at.start..at.start + name.len();
            return self.refuse(&place, format!("there is no function {name}; {}", instead(name, &known)));
        };
        if arguments.len() != wanted {
            let plural = if wanted == 1 { "" } else { "s" };
            return self.refuse(at, format!("{name} takes {wanted} argument{plural}, not {}", arguments.len()));
        }
        let mut parts: Vec<Part> = arguments.iter().map(|node| self.part(node)).collect();
        match (over, function) {
            (Some(OverTime::Smooth), _) => match parts.remove(1) {
                Part::Number(seconds) if seconds > 0.0 => Part::Over(OverTime::Smooth, parts.remove(0).into(), seconds),
                _ => {
                    self.refuse(&arguments[1].at, "write the seconds to average over as a number, such as 0.02".into())
                }
            },
            (Some(over), _) => Part::Over(over, parts.remove(0).into(), 0.0),
            (None, Some(function)) => Part::Call(function, parts),
            (None, None) => Part::Number(0.0),
        }
    }

    fn refuse(&mut self, at: &Range<usize>, message: String) -> Part {
        self.mistakes.push(Mistake::new(at.clone(), message));
        Part::Number(0.0)
    }
}
