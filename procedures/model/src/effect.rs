//! What an effect is: one physical cause with its formula, its parameters and the signals that it needs.

use crate::signal::Signal;
use crate::view::View;
use jointbench_instrument::Kind;
use jointbench_instrument::spelling::nearest;
use serde::Serialize;
use std::borrow::Cow;

/// What people read about an effect, and what it needs. Borrowed: from the program for an effect of the library, from
/// the model for one that a user wrote.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EffectInfo<'e> {
    pub id: &'e str,
    pub kind: Kind,
    pub title: &'e str,
    /// One sentence that a technician understands.
    pub sentence: &'e str,
    pub formula: &'e str,
    /// Document and equation, or paper.
    pub source: &'e str,
    /// How the residual looks when the effect is missing.
    pub looks: &'e str,
    pub parameters: &'e [ParameterInfo],
    /// Columns beside the required ones, without which the effect is not visible.
    pub needs: &'e [&'static str],
}

impl<'e> EffectInfo<'e> {
    /// Unit of a parameter.
    pub fn unit(&self, name: &str) -> &'e str {
        self.parameter(name).map_or("1", |p| &p.unit)
    }

    /// The least and the largest value of a parameter that is physically sensible.
    pub(crate) fn bounds(&self, name: &str) -> (f64, f64) {
        self.parameter(name).map_or((f64::NEG_INFINITY, f64::INFINITY), |p| (p.min, p.max))
    }

    /// `a_2` is the second of its kind and is what `a` is.
    fn parameter(&self, name: &str) -> Option<&'e ParameterInfo> {
        let family = name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_');
        let find = |name: &str| self.parameters.iter().find(|p| p.name == name);
        find(name).or_else(|| find(family))
    }
}

/// A parameter with what is physically sensible for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterInfo {
    pub name: Cow<'static, str>,
    pub unit: Cow<'static, str>,
    pub min: f64,
    pub max: f64,
}

/// Shorthand for the tables in the effects' files.
pub(crate) const fn parameter(name: &'static str, unit: &'static str, min: f64, max: f64) -> ParameterInfo {
    ParameterInfo { name: Cow::Borrowed(name), unit: Cow::Borrowed(unit), min, max }
}

/// Columns of an effect at the points of a view: the effect is their sum, each times its factor.
pub type Columns = Vec<Vec<f64>>;

/// One way of writing an effect. The forms of one effect are one group: at most one of them is in a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Form<'e> {
    pub name: &'e str,
    /// Names of the factors, one for each column.
    pub linear: Vec<&'e str>,
    /// Parameters that the columns depend on.
    pub shape: Vec<Shape<'e>>,
    /// Starting points of the search, one value for each shape parameter.
    pub grid: Vec<Vec<f64>>,
}

/// A parameter that an effect is not linear in, with the range that this data can speak about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape<'e> {
    pub name: &'e str,
    pub min: f64,
    pub max: f64,
    pub search: ShapeSearch,
}

/// How the best value of a shape parameter is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShapeSearch {
    /// Refined continuously, in its logarithm.
    Smooth,
    /// Refined continuously, in itself: it may be zero or negative.
    Signed,
    /// A whole number: found on the grid and not refined.
    Whole,
    /// A moment at which the columns jump: narrowed down by halving.
    Jump,
}

impl Shape<'_> {
    /// The value after a step: in its logarithm, or in shares of its range.
    pub fn moved(&self, value: f64, step: f64) -> f64 {
        match self.search {
            ShapeSearch::Signed => value + step * (self.max - self.min),
            ShapeSearch::Smooth | ShapeSearch::Whole | ShapeSearch::Jump => value * step.exp(),
        }
    }

    /// A value lies at the edge of what the data can speak about.
    pub fn is_edge(&self, value: f64) -> bool {
        self.is_at(value, self.min) || self.is_at(value, self.max)
    }

    /// A value is as good as one of the ends.
    pub fn is_at(&self, value: f64, end: f64) -> bool {
        (value - end).abs() <= 1e-3 * end.abs().max(1e-3 * (self.max - self.min))
    }

    /// It is refined continuously, and not held where it is.
    pub fn is_smooth(&self) -> bool {
        self.min < self.max && matches!(self.search, ShapeSearch::Smooth | ShapeSearch::Signed)
    }
}

impl<'e> Form<'e> {
    /// A form without shape parameters.
    pub fn linear(linear: &[&'e str]) -> Self {
        Self { name: "linear", linear: linear.to_vec(), shape: Vec::new(), grid: vec![Vec::new()] }
    }
}

/// On which part of the data an effect is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regime {
    /// Where the motion has settled.
    SteadyState,
    /// Where speed changes: plateaus say nothing about it.
    Transient,
    /// Around reversals, where the past matters.
    Hysteresis,
}

pub trait Effect: Sync {
    fn info(&self) -> EffectInfo<'_>;

    /// Ways of writing the effect that this data can speak about. Empty: not visible.
    fn forms(&self, view: &View) -> Vec<Form<'_>>;

    /// The columns of one form at the points of the view.
    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns;

    /// The formula of one form, where it is not that of all.
    fn formula_of(&self, _form: &str) -> &str {
        self.info().formula
    }

    /// The form with one more part and one more shape parameter, and the form that finds this part alone. `None` for a
    /// form that is not a sum of like parts, or is long enough.
    fn extended(&self, _form: &Form) -> Option<(&'static str, Form<'static>)> {
        None
    }

    fn regime(&self) -> Regime {
        Regime::SteadyState
    }

    /// The angle over which it is a wave, as often in a turn as its shape says.
    fn wave(&self) -> Option<Signal> {
        None
    }

    /// A shape parameter that says only how suddenly the effect comes and goes. At the edge of its range the effect is there
    /// all the same.
    fn exponent_parameter(&self) -> Option<&'static str> {
        None
    }

    /// Its formula is no approximation: what is left of the effect is not what the formula cannot follow.
    fn is_exact(&self) -> bool {
        false
    }

    /// Its factors are those of this run's repeats: another run has others, of the same size.
    fn is_nuisance(&self) -> bool {
        false
    }

    /// The effect enters with a factor of one and nothing to fit.
    fn is_offset(&self) -> bool {
        false
    }

    /// The first column without which the effect cannot be computed here.
    fn missing(&self, view: &View) -> Option<&'static str> {
        let absent = |need: &&&str| view.find(Signal::named(need)).is_none();
        self.info().needs.iter().find(absent).copied()
    }

    /// It is computed from the motion of the link. Where one side of the joint is held that motion is the twist itself.
    fn needs_motion(&self) -> bool {
        false
    }

    /// The effect that this one is one and the same with in such data, and that stands for both.
    fn same_as(&self, _view: &View) -> Option<&'static str> {
        None
    }

    /// The effect whose formula this one corrects: it is sought beside that one only (marginality, Nelder 1977).
    fn corrects(&self) -> Option<&'static str> {
        None
    }

    /// What there would have to be to see, or why there is nothing.
    fn unseen(&self) -> &str {
        self.info().looks
    }

    /// Why this data cannot show the effect: a needed signal is missing or never changes.
    fn hidden(&self, view: &View) -> Option<String> {
        let info = self.info();
        if let Some(need) = self.missing(view) {
            let others = view.points.iter().filter_map(|(signal, _)| match signal {
                Signal::Column(column) => Some(column),
                _ => None,
            });
            let meant = nearest(need, others).map(|near| format!("; did you mean {near}?"));
            return Some(format!("the run has no column {need}{}", meant.unwrap_or_default()));
        }
        if let Some(turns) = view.constants.held_turns.filter(|_| self.needs_motion()) {
            return Some(format!(
                "one side of the joint is held and the link turns by {turns:.4} of a turn: its motion is the twist itself, \
                 which it cannot explain; turn the joint under load"
            ));
        }
        let still = |need: &&&str| view.find(Signal::named(need)).is_some_and(is_constant);
        if let Some(need) = info.needs.iter().find(still) {
            return Some(format!("{need} never changes"));
        }
        if let Some(other) = self.same_as(view) {
            return Some(format!(
                "the motion has one direction only, in which it equals {other}, which represents both; measure the other direction as well"
            ));
        }
        if self.forms(view).is_empty() { Some(format!("it would not show: {}", self.unseen())) } else { None }
    }
}

fn is_constant(values: &[f64]) -> bool {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    high <= low + 1e-12 * high.abs().max(low.abs())
}
