//! Consistency of the units of a formula.
//!
//! A unit consists of the exponents of five base units; angles have none. A number without a unit may represent any
//! quantity, so that an expression with such a number is not checked.

use crate::formula::expression::{Expression, What};
use crate::formula::fault::Mistake;
use crate::formula::function::Function;
use crate::formula::signals::{left_hand_side, signals};
use crate::formula::syntax;
use crate::formula::syntax::{Node, Operator, Syntax};
use crate::signal::Signal;
use jointbench_instrument::Kind;
use jointbench_instrument::units::unit_of;

/// Exponents of kg, m, s, A and K.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Unit([f64; 5]);

const PLAIN: Unit = Unit([0.0; 5]);

const KNOWN: &[(&str, Unit)] = &[
    ("rad", PLAIN),
    ("kg", Unit([1.0, 0.0, 0.0, 0.0, 0.0])),
    ("m", Unit([0.0, 1.0, 0.0, 0.0, 0.0])),
    ("s", Unit([0.0, 0.0, 1.0, 0.0, 0.0])),
    ("Hz", Unit([0.0, 0.0, -1.0, 0.0, 0.0])),
    ("A", Unit([0.0, 0.0, 0.0, 1.0, 0.0])),
    ("K", Unit([0.0, 0.0, 0.0, 0.0, 1.0])),
    ("°C", Unit([0.0, 0.0, 0.0, 0.0, 1.0])),
    ("N", Unit([1.0, 1.0, -2.0, 0.0, 0.0])),
    ("Nm", Unit([1.0, 2.0, -2.0, 0.0, 0.0])),
    ("Pa", Unit([1.0, -1.0, -2.0, 0.0, 0.0])),
    ("W", Unit([1.0, 2.0, -3.0, 0.0, 0.0])),
    ("V", Unit([1.0, 2.0, -3.0, -1.0, 0.0])),
];

/// The first position of contradicting units: for a rotating joint, and for a sliding joint.
///
/// `whole` is the right-hand side of `text`, `units` those of the parameters.
pub fn check(kind: Kind, text: &str, whole: &Expression, units: &[&str]) -> [Option<Mistake>; 2] {
    // The unit of an unknown column can be any.
    let names_other = whole.any(&mut |what| matches!(what, What::Signal(Signal::Column(_))));
    let is_foreign = |unit: &&&str| unit.trim() != "1" && read(unit).is_none() && !names_other;
    if let Some(foreign) = units.iter().find(is_foreign) {
        let message = format!("a formula counts in SI units, and [{foreign}] is none: what is fitted is not converted");
        let foreign = Mistake::new(0..0, message);
        return [Some(foreign.clone()), Some(foreign)];
    }
    let units: Vec<Option<Unit>> = units.iter().map(|unit| read(unit)).collect();
    [false, true].map(|slides| Check { kind, text, units: &units, slides }.whole(whole).err())
}

/// `None` for unknown units, and for 1, which is the default of a parameter without a unit.
fn read(text: &str) -> Option<Unit> {
    let mut spelled = text.trim().replace('·', "*").replace("°C", "K").replace('⁻', "^-");
    for (digit, written) in [('²', "2"), ('³', "3"), ('¹', "1"), ('⁴', "4")] {
        spelled = spelled.replace(digit, &format!("^{written}")).replace("^-^", "^-");
    }
    if spelled == "1" { None } else { of_node(&syntax::tree_of(&spelled).ok()?) }
}

fn of_node(node: &Node) -> Option<Unit> {
    match &node.what {
        Syntax::Number(1.0) => Some(PLAIN),
        Syntax::Name(name) => KNOWN.iter().find(|(known, _)| known == name).map(|(_, unit)| *unit),
        Syntax::Binary(Operator::Multiply, a, b) => Some(of_node(a)?.times(of_node(b)?, 1.0)),
        Syntax::Binary(Operator::Divide, a, b) => Some(of_node(a)?.times(of_node(b)?, -1.0)),
        Syntax::Binary(Operator::Power, a, b) => {
            let exponent = match &b.what {
                Syntax::Number(n) => *n,
                Syntax::Negate(n) => match n.what {
                    Syntax::Number(n) => -n,
                    _ => return None,
                },
                _ => return None,
            };
            Some(PLAIN.times(of_node(a)?, exponent))
        }
        _ => None,
    }
}

impl Unit {
    /// `self · other^exponent`.
    fn times(self, other: Unit, exponent: f64) -> Unit {
        Unit(std::array::from_fn(|i| self.0[i] + exponent * other.0[i]))
    }
}

impl std::fmt::Display for Unit {
    /// With forces and torques instead of masses.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [kg, m, s, a, k] = self.0;
        let is_torque = m == 2.0 * kg;
        let m = m - if is_torque { 2.0 } else { 1.0 } * kg;
        let all = [(if is_torque { "Nm" } else { "N" }, kg), ("A", a), ("K", k), ("m", m), ("s", s + 2.0 * kg)];
        let power = |(name, exponent): &(&str, f64)| match exponent.abs() {
            1.0 => (*name).to_owned(),
            2.0 => format!("{name}²"),
            3.0 => format!("{name}³"),
            other => format!("{name}^{other}"),
        };
        let above: Vec<String> = all.iter().filter(|(_, e)| *e > 0.0).map(power).collect();
        let below: Vec<String> = all.iter().filter(|(_, e)| *e < 0.0).map(power).collect();
        let above = if above.is_empty() { "1".to_owned() } else { above.join("·") };
        match below.as_slice() {
            [] => write!(f, "{above}"),
            [one] => write!(f, "{above}/{one}"),
            several => write!(f, "{above}/({})", several.join("·")),
        }
    }
}

struct Check<'c> {
    kind: Kind,
    text: &'c str,
    units: &'c [Option<Unit>],
    /// Metres and newtons replace radians and newton metres.
    slides: bool,
}

/// `None` if the unit is unknown.
type Found = Result<Option<Unit>, Mistake>;

impl Check<'_> {
    fn whole(&self, e: &Expression) -> Result<(), Mistake> {
        let (left, signal_unit) = match self.kind {
            Kind::Friction | Kind::Brake => (left_hand_side(self.kind), "Nm"),
            Kind::Encoder | Kind::Stiffness => (left_hand_side(self.kind), "rad"),
        };
        match (self.of(e)?, self.signal(signal_unit)) {
            (Some(unit), Some(wanted)) if unit != wanted => {
                Err(Mistake::new(e.at.clone(), format!("{left} is in {wanted}, but this is in {unit}{CURE}")))
            }
            _ => Ok(()),
        }
    }

    fn signal(&self, unit: &str) -> Option<Unit> {
        if self.slides { read(&unit.replace("rad", "m").replace("Nm", "N")) } else { read(unit) }
    }

    fn of(&self, e: &Expression) -> Found {
        match &e.what {
            What::Number(_) => Ok(None),
            What::Parameter(p) => Ok(self.units[*p]),
            What::Signal(signal) => {
                if let Signal::Column(column) = signal {
                    return Ok(unit_of(column).and_then(read));
                }
                let named = signals(self.kind).iter().find(|s| s.signal == *signal);
                // A signal with the unit 1 is dimensionless, not a signal without a unit.
                Ok(named.and_then(|s| if s.unit == "1" { Some(PLAIN) } else { self.signal(s.unit) }))
            }
            What::Negate(a) => self.of(a),
            What::Binary(Operator::Add | Operator::Subtract, a, b) => self.alike(a, b),
            What::Binary(Operator::Multiply, a, b) => self.product(a, b, 1.0),
            What::Binary(Operator::Divide, a, b) => self.product(a, b, -1.0),
            What::Binary(Operator::Power, a, b) => {
                self.plain(b, "an exponent")?;
                let base = self.of(a)?;
                Ok(match (base, &b.what) {
                    (Some(unit), _) if unit == PLAIN => base,
                    (Some(unit), What::Number(n)) => Some(PLAIN.times(unit, *n)),
                    _ => None,
                })
            }
            What::Call(Function::Abs, a) => self.of(&a[0]),
            What::Call(Function::Sign, a) => self.of(&a[0]).map(|_| Some(PLAIN)),
            What::Call(Function::Sqrt, a) => Ok(self.of(&a[0])?.map(|unit| PLAIN.times(unit, 0.5))),
            What::Call(Function::Min | Function::Max, a) => self.alike(&a[0], &a[1]),
            What::Call(Function::Atan2, a) => self.alike(&a[0], &a[1]).map(|_| Some(PLAIN)),
            What::Call(function, a) => self.plain(&a[0], function.name()).map(|()| Some(PLAIN)),
        }
    }

    fn product(&self, a: &Expression, b: &Expression, exponent: f64) -> Found {
        Ok(self.of(a)?.zip(self.of(b)?).map(|(a, b)| a.times(b, exponent)))
    }

    fn plain(&self, e: &Expression, taker: &str) -> Result<(), Mistake> {
        match self.of(e)? {
            Some(unit) if unit != PLAIN => {
                Err(Mistake::new(e.at.clone(), format!("{taker} takes a plain number, but this is in {unit}{CURE}")))
            }
            _ => Ok(()),
        }
    }

    /// The common unit of two terms.
    fn alike(&self, a: &Expression, b: &Expression) -> Found {
        match (self.of(a)?, self.of(b)?) {
            (Some(first), Some(second)) if first != second => {
                let (a, at) = (&self.text[a.at.clone()], b.at.clone());
                Err(Mistake::new(at, format!("this is in {second}, but {a} is in {first}{CURE}")))
            }
            (first, second) => Ok(first.or(second)),
        }
    }
}

/// Advice for the user.
const CURE: &str = ": look at the units of the parameters (a radian counts as 1)";
