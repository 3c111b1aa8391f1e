//! An effect: one physical cause with its formula, its parameters and the signals that it needs.

use crate::signal::Signal;
use crate::stats::summary::range;
use crate::symbolic::{self, FittedForm, Symbolic};
use crate::view::View;
use jointbench_instrument::Kind;
use jointbench_instrument::spelling::nearest;
use serde::Serialize;
use std::borrow::Cow;

/// Description and requirements of an effect. A library effect borrows them from the program, a user effect from the
/// model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EffectInfo<'e> {
    /// Stable identifier, as in model lists and JSON results: `stribeck`.
    pub id: &'e str,
    /// Kind of run whose response the effect is a part of.
    pub kind: Kind,
    /// Name for users: `Stribeck effect`.
    pub title: &'e str,
    /// One sentence for users.
    pub sentence: &'e str,
    /// Contribution to the response, with the parameters by their names: `τ_c·sign ω`.
    pub formula: &'e str,
    /// Document and equation, or paper.
    pub source: &'e str,
    /// Appearance of the residual if the effect is missing.
    pub looks: &'e str,
    /// Coefficients and nonlinear parameters of all forms, each once; a family `a_1`, `a_2`, … is listed as `a`.
    pub parameters: &'e [ParameterInfo],
    /// Columns in addition to the required ones, without which the effect is not visible.
    pub needs: &'e [&'static str],
}

impl<'e> EffectInfo<'e> {
    /// Unit of a parameter.
    pub fn unit(&self, name: &str) -> &'e str {
        self.parameter(name).map_or("1", |p| &p.unit)
    }

    /// Physical bounds of a parameter.
    pub(crate) fn bounds(&self, name: &str) -> (f64, f64) {
        self.parameter(name).map_or((f64::NEG_INFINITY, f64::INFINITY), |p| (p.min, p.max))
    }

    /// `a_2` is the second parameter of the family `a` and has its properties.
    pub(crate) fn parameter(&self, name: &str) -> Option<&'e ParameterInfo> {
        let family = name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_');
        let find = |name: &str| self.parameters.iter().find(|p| p.name == name);
        find(name).or_else(|| find(family))
    }
}

/// A parameter with its physical bounds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterInfo {
    /// Name in JSON results, tables and exported code: `tau_c`.
    pub name: Cow<'static, str>,
    /// SI unit for a rotating joint, `1` if dimensionless; for a sliding joint rad is m, and Nm is N.
    pub unit: Cow<'static, str>,
    /// Smallest physically possible value, −∞ if unbounded. An interval outside gives `impossible`.
    pub min: f64,
    /// Largest physically possible value, ∞ if unbounded.
    pub max: f64,
}

/// Shorthand for the tables in the effects' files.
pub(crate) const fn parameter(name: &'static str, unit: &'static str, min: f64, max: f64) -> ParameterInfo {
    ParameterInfo { name: Cow::Borrowed(name), unit: Cow::Borrowed(unit), min, max }
}

/// Columns of an effect at the points of a view: the effect is the sum of coefficient times column.
pub type Columns = Vec<Vec<f64>>;

/// A form of an effect. A model contains at most one form of each effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Form<'e> {
    /// Name of the form within its effect, as stored in a fit: `linear` or `lugre`.
    pub name: &'e str,
    /// Names of the coefficients, one for each column.
    pub linear: Vec<&'e str>,
    /// Nonlinear parameters of the columns.
    pub shape: Vec<Shape<'e>>,
    /// Starting points of the search, one value for each nonlinear parameter.
    pub grid: Vec<Vec<f64>>,
}

/// A nonlinear parameter, with the range that this data can identify.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape<'e> {
    /// Name of the parameter, one of [`EffectInfo::parameters`] or of a family there.
    pub name: &'e str,
    /// Smallest value that this data can identify.
    pub min: f64,
    /// Largest value that this data can identify; equal to `min` for a fixed parameter.
    pub max: f64,
    /// How the fit searches for the value between its starting points.
    pub search: ShapeSearch,
}

/// Search method for a nonlinear parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShapeSearch {
    /// Refined continuously, in its logarithm.
    Smooth,
    /// Refined continuously without a logarithm: it may be zero or negative.
    Signed,
    /// An integer: found on the grid and not refined.
    Whole,
    /// A changepoint of the columns: refined by interval reduction.
    Jump,
}

impl Shape<'_> {
    /// The value after a step, in its logarithm or as a share of its range.
    pub fn stepped(&self, value: f64, step: f64) -> f64 {
        match self.search {
            ShapeSearch::Signed => value + step * (self.max - self.min),
            ShapeSearch::Smooth | ShapeSearch::Whole | ShapeSearch::Jump => value * step.exp(),
        }
    }

    /// Whether a value is at a bound of the identifiable range.
    pub fn is_edge(&self, value: f64) -> bool {
        self.is_at(value, self.min) || self.is_at(value, self.max)
    }

    /// Whether a value practically equals `end`.
    pub fn is_at(&self, value: f64, end: f64) -> bool {
        (value - end).abs() <= 1e-3 * end.abs().max(1e-3 * (self.max - self.min))
    }

    /// Whether it is refined continuously and not fixed.
    pub fn is_smooth(&self) -> bool {
        self.min < self.max && matches!(self.search, ShapeSearch::Smooth | ShapeSearch::Signed)
    }
}

impl<'e> Form<'e> {
    /// A form without nonlinear parameters.
    pub fn linear(linear: &[&'e str]) -> Self {
        Self { name: "linear", linear: linear.to_vec(), shape: Vec::new(), grid: vec![Vec::new()] }
    }
}

/// The part of the data that an effect is judged on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Regime {
    /// Constant speed and load.
    #[default]
    SteadyState,
    /// Changing speed; steady-state means contain no such effects.
    Transient,
    /// Around reversals, where the loading history matters.
    Hysteresis,
}

/// What the selection and the diagnosis have to know about an effect. Default: an effect at steady state without
/// peculiarities.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Traits {
    /// The part of the data that shows the effect.
    pub regime: Regime,
    /// The angle of a periodic effect; its nonlinear parameter is the number of waves in a turn.
    pub wave: Option<Signal>,
    /// A nonlinear parameter that only describes how suddenly the effect starts and ends. At the bound of its range
    /// the effect is still identified.
    pub exponent_parameter: Option<&'static str>,
    /// The effect whose formula this one corrects: it is a candidate only together with that one (marginality, Nelder
    /// 1977).
    pub corrects: Option<&'static str>,
    /// A temperature effect over time instead of temperature, as an inline user effect: if temperature follows time in
    /// a run, both explain it.
    pub over_time: Option<&'static str>,
    /// The missing excitation, or why the effect is not visible. Default: how its residual looks.
    pub unseen: Option<&'static str>,
    /// Excitation that would distinguish the effect from others. Default: that of its regime and its columns.
    pub excitation: Option<&'static str>,
    /// Whether the formula is exact, so that the effect leaves no form error.
    pub is_exact: bool,
    /// Whether the coefficients belong to this run's repeats: another run has other values of the same size.
    pub is_nuisance: bool,
    /// Whether the effect is an offset term: it has the coefficient one and no parameters.
    pub is_offset: bool,
    /// Whether it is computed from the motion of the link. If one side of the joint is clamped, that motion is the
    /// twist itself.
    pub needs_motion: bool,
    /// The effect that a delay delays: the coefficient of the delay divided by that of the effect is a time. In a run
    /// that is judged sample by sample, the form error of the jerk represents the same delay.
    pub delay_of: Option<&'static str>,
    /// Whether it changes the direction of friction in a run that is judged sample by sample, and is no column there.
    pub changes_direction: bool,
    /// Whether a user wrote the formula. The selection prefers an effect of the library that explains the same.
    pub is_user_defined: bool,
    /// Whether a user has set parameters of the effect.
    pub is_set: bool,
}

/// One physical cause as a sum of coefficients times columns. The columns may depend on nonlinear parameters.
///
/// [`Effect::info`], [`Effect::forms`] and [`Effect::columns`] are required; the other methods have defaults.
///
/// ```
/// use jointbench_instrument::Kind;
/// use jointbench_model::effects::find;
/// use jointbench_model::signal::{Signal, Signals};
/// use jointbench_model::view::View;
/// use jointbench_model::{Effect, EffectInfo};
///
/// let mut signals = Signals::new(4);
/// signals.set(Signal::Velocity, vec![-2.0, -1.0, 1.0, 2.0]);
/// signals.set(Signal::Direction, vec![-1.0, -1.0, 1.0, 1.0]);
/// let view = View::new(signals.clone(), signals, Vec::new(), vec![0], 0.01);
///
/// let coulomb: &dyn Effect = find(Kind::Friction, "coulomb").unwrap();
/// let EffectInfo { parameters, .. } = coulomb.info();
/// assert_eq!((parameters[0].name.as_ref(), parameters[0].unit.as_ref()), ("tau_c", "Nm"));
/// // One form without nonlinear parameters: its column is the direction of motion.
/// let form = &coulomb.forms(&view)[0];
/// assert_eq!(coulomb.columns(form.name, &[], &view), [vec![-1.0, -1.0, 1.0, 1.0]]);
/// // Gravity needs the link angle, which this data does not contain.
/// let gravity = find(Kind::Friction, "gravity").unwrap();
/// assert_eq!(gravity.missing(&view), Some("link_position_rad"));
/// ```
pub trait Effect: Sync {
    /// Description, parameters and required columns of the effect.
    fn info(&self) -> EffectInfo<'_>;

    /// Forms of the effect that this data can identify. Empty: not visible.
    fn forms(&self, view: &View) -> Vec<Form<'_>>;

    /// The columns of one form at the points of the view.
    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns;

    /// The columns of a form as formulas for a controller, or why it cannot compute them.
    fn symbolic(&self, _form: &FittedForm) -> Symbolic {
        Err(symbolic::UNKNOWN)
    }

    /// The formula of one form, if it differs from that of the effect.
    fn formula_of(&self, _form: &str) -> &str {
        self.info().formula
    }

    /// The form with one more component and one more nonlinear parameter, and the name of the form of that component
    /// alone. `None` for a form that is not a sum of equal components, or is long enough.
    fn extended(&self, _form: &Form) -> Option<(&'static str, Form<'static>)> {
        None
    }

    /// What the selection and the diagnosis have to know about the effect.
    fn traits(&self) -> Traits {
        Traits::default()
    }

    /// Every coefficient of the only form, with the value of those that are fixed. Empty: none is fixed.
    fn coefficients(&self) -> &[(String, Option<f64>)] {
        &[]
    }

    /// The sum of the columns whose coefficients are fixed; [`Effect::columns`] does not contain them.
    fn fixed_part(&self, _form: &str, _shape: &[f64], _view: &View) -> Option<Vec<f64>> {
        None
    }

    /// The first missing column that the effect needs.
    fn missing(&self, view: &View) -> Option<&'static str> {
        let absent = |need: &&&str| view.find(Signal::named(need)).is_none();
        self.info().needs.iter().find(absent).copied()
    }

    /// The aliased effect that is identical to this one in such data, and represents both.
    fn same_as(&self, _view: &View) -> Option<&'static str> {
        None
    }

    /// Why this data cannot show the effect: a needed signal is missing or constant.
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
        if view.constants.is_held && self.traits().needs_motion {
            let why = "one side of the joint is held, so that the only motion is the deformation itself; move the joint under load";
            return Some(why.into());
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
        if self.forms(view).is_empty() {
            Some(match self.traits().unseen {
                Some(unseen) => format!("this data cannot show it: {unseen}"),
                None => format!("this data cannot show its signature: {}", info.looks),
            })
        } else {
            None
        }
    }
}

fn is_constant(values: &[f64]) -> bool {
    let (low, high) = range(values);
    high <= low + 1e-12 * high.abs().max(low.abs())
}
