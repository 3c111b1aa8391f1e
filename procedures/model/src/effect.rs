//! What an effect is: one physical cause with its formula, its parameters and the signals that it needs.

use crate::view::{Signal, View};
use jointbench_instrument::Kind;
use serde::Serialize;

/// What people read about an effect, and what it needs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectInfo {
    pub id: &'static str,
    pub kind: Kind,
    pub title: &'static str,
    /// One sentence that a technician understands.
    pub sentence: &'static str,
    pub formula: &'static str,
    /// Document and equation, or paper.
    pub source: &'static str,
    /// How the residual looks when the effect is missing.
    pub looks: &'static str,
    pub parameters: &'static [ParameterInfo],
    /// Columns beside the required ones, without which the effect is not visible.
    pub needs: &'static [&'static str],
}

impl EffectInfo {
    /// Unit of a parameter. `a_2` is the second of its kind and has the unit of `a`.
    pub fn unit(&self, name: &str) -> &'static str {
        let family = name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_');
        let find = |name: &str| self.parameters.iter().find(|p| p.name == name);
        find(name).or_else(|| find(family)).map_or("1", |p| p.unit)
    }
}

/// A parameter with what is physically sensible for it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ParameterInfo {
    pub name: &'static str,
    pub unit: &'static str,
    pub min: f64,
    pub max: f64,
}

/// Shorthand for the tables in the effects' files.
pub(crate) const fn parameter(name: &'static str, unit: &'static str, min: f64, max: f64) -> ParameterInfo {
    ParameterInfo { name, unit, min, max }
}

/// Columns of an effect at the points of a view: the effect is their sum, each times its factor.
pub type Columns = Vec<Vec<f64>>;

/// One way of writing an effect. The forms of one effect are one group: at most one of them is in a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Form {
    pub name: &'static str,
    /// Names of the factors, one for each column.
    pub linear: &'static [&'static str],
    /// Parameters that the columns depend on.
    pub shape: Vec<Shape>,
    /// Starting points of the search, one value for each shape parameter.
    pub grid: Vec<Vec<f64>>,
}

/// A parameter that an effect is not linear in, with the range that this data can speak about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    pub name: &'static str,
    pub min: f64,
    pub max: f64,
    pub search: Search,
}

/// How the best value of a shape parameter is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Search {
    /// Refined continuously, in its logarithm.
    Smooth,
    /// A whole number: found on the grid and not refined.
    Whole,
    /// A moment at which the columns jump: narrowed down by halving.
    Jump,
}

impl Form {
    /// A form without shape parameters.
    pub fn linear(linear: &'static [&'static str]) -> Self {
        Self { name: "linear", linear, shape: Vec::new(), grid: vec![Vec::new()] }
    }
}

/// On which part of the data an effect is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Where the motion has settled.
    Settled,
    /// Where speed changes: plateaus say nothing about it.
    Ramp,
    /// Around reversals, where the past matters.
    Memory,
}

pub trait Effect: Sync {
    fn info(&self) -> &'static EffectInfo;

    /// Ways of writing the effect that this data can speak about. Empty: not visible.
    fn forms(&self, view: &View) -> Vec<Form>;

    /// The columns of one form at the points of the view.
    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns;

    fn stage(&self) -> Stage {
        Stage::Settled
    }

    /// The effect enters with a factor of one and nothing to fit.
    fn is_given(&self) -> bool {
        false
    }

    /// Why this data cannot show the effect: a needed signal is missing or never changes.
    fn hidden(&self, view: &View) -> Option<String> {
        let info = self.info();
        for need in info.needs {
            let Some(signal) = Signal::of_column(need) else { continue };
            match view.find(signal) {
                None => return Some(format!("the run has no column {need}")),
                Some(values) if is_constant(values) => return Some(format!("{need} never changes")),
                Some(_) => {}
            }
        }
        if self.forms(view).is_empty() { Some(format!("it would not show: {}", info.looks)) } else { None }
    }
}

fn is_constant(values: &[f64]) -> bool {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    high <= low + 1e-12 * high.abs().max(low.abs())
}
