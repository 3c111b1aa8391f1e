//! An effect some of whose parameters a user has set.

use crate::effect::{Columns, Effect, EffectInfo, Form, Shape, ShapeSearch, Traits};
use crate::effects;
use crate::report::setting::ParameterSetting;
use crate::symbolic::{FittedForm, Symbolic};
use crate::view::View;
use crate::{ModelError, UserEffect};
use jointbench_instrument::Kind;
use std::fmt;

/// The effect itself.
#[derive(Clone)]
enum Whole {
    Library(&'static dyn Effect),
    Own(Box<UserEffect>),
}

/// A form with fixed coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct Pinned {
    /// Name of the form.
    pub form: String,
    /// Start values of its nonlinear parameters.
    pub start: Vec<f64>,
    /// All its coefficients, with the value of those that are fixed.
    pub coefficients: Vec<(String, Option<f64>)>,
}

/// An effect with settings of its nonlinear parameters, and with fixed coefficients if its form is known.
///
/// The range of a bounded or fixed nonlinear parameter is smaller. A fixed coefficient has no column; its contribution
/// is a separate part.
#[derive(Clone)]
pub struct SetEffect {
    whole: Whole,
    nonlinear: Vec<ParameterSetting>,
    pinned: Option<Pinned>,
}

impl SetEffect {
    pub fn new(
        kind: Kind,
        user_effects: &[UserEffect],
        id: &str,
        nonlinear: Vec<ParameterSetting>,
    ) -> Result<Self, ModelError> {
        let whole = match user_effects.iter().find(|user_effect| user_effect.id() == id) {
            Some(user_effect) => Whole::Own(Box::new(user_effect.clone())),
            None => Whole::Library(effects::find(kind, id)?),
        };
        Ok(Self { whole, nonlinear, pinned: None })
    }

    /// The same effect in one form, with fixed coefficients.
    pub fn pinned(&self, pinned: Pinned) -> Self {
        Self { pinned: Some(pinned), ..self.clone() }
    }

    fn whole(&self) -> &dyn Effect {
        match &self.whole {
            Whole::Library(effect) => *effect,
            Whole::Own(effect) => effect.as_ref(),
        }
    }

    /// The form with the ranges and start values of the settings. `None` if it has no such values.
    fn restricted<'e>(&'e self, mut form: Form<'e>) -> Option<Form<'e>> {
        for setting in &self.nonlinear {
            let k = form.shape.iter().position(|shape| shape.name == setting.name)?;
            restrict(&mut form.shape[k], setting);
            let (shape, start) = (form.shape[k], setting.start);
            match shape.search {
                ShapeSearch::Whole if setting.fixed.is_none() => {
                    form.grid.retain(|point| (shape.min..=shape.max).contains(&point[k]));
                }
                _ => form.grid.iter_mut().for_each(|point| {
                    point[k] = start.unwrap_or(point[k]).clamp(shape.min, shape.max);
                }),
            }
        }
        if let Some(pinned) = &self.pinned {
            form.grid = vec![pinned.start.clone()];
            let mut is_free = pinned.coefficients.iter().map(|(_, fixed)| fixed.is_none());
            form.linear.retain(|_| is_free.next().unwrap_or(true));
        }
        let mut grid: Vec<Vec<f64>> = Vec::new();
        for point in std::mem::take(&mut form.grid) {
            if !grid.contains(&point) {
                grid.push(point);
            }
        }
        form.grid = grid;
        (!form.grid.is_empty()).then_some(form)
    }
}

/// Reduces the range of a nonlinear parameter. Outside the range that the data can identify, only the nearest bound of
/// the setting remains.
fn restrict(shape: &mut Shape, setting: &ParameterSetting) {
    (shape.min, shape.max) = match setting.fixed {
        Some(value) => (value, value),
        None => {
            let (low, high) = (setting.nearest(shape.min), setting.nearest(shape.max));
            (low.min(high), high.max(low))
        }
    };
}

impl fmt::Debug for SetEffect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let id = self.whole().info().id;
        f.debug_struct("SetEffect").field("id", &id).field("nonlinear", &self.nonlinear).finish_non_exhaustive()
    }
}

impl PartialEq for SetEffect {
    fn eq(&self, other: &Self) -> bool {
        self.whole().info() == other.whole().info() && self.nonlinear == other.nonlinear && self.pinned == other.pinned
    }
}

impl Effect for SetEffect {
    fn info(&self) -> EffectInfo<'_> {
        self.whole().info()
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let is_open = |form: &Form| self.pinned.as_ref().is_none_or(|pinned| pinned.form == form.name);
        let forms = self.whole().forms(view).into_iter().filter(is_open);
        forms.filter_map(|form| self.restricted(form)).collect()
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        let mut columns = self.whole().columns(form, shape, view);
        if let Some(pinned) = &self.pinned {
            let mut is_free = pinned.coefficients.iter().map(|(_, fixed)| fixed.is_none());
            columns.retain(|_| is_free.next().unwrap_or(true));
        }
        columns
    }

    fn traits(&self) -> Traits {
        Traits { is_set: self.pinned.is_some() || !self.nonlinear.is_empty(), ..self.whole().traits() }
    }

    fn coefficients(&self) -> &[(String, Option<f64>)] {
        self.pinned.as_ref().map_or(&[], |pinned| &pinned.coefficients)
    }

    fn fixed_part(&self, form: &str, shape: &[f64], view: &View) -> Option<Vec<f64>> {
        let pinned = self.pinned.as_ref()?;
        let mut sum = vec![0.0; view.len()];
        for (column, (_, fixed)) in self.whole().columns(form, shape, view).iter().zip(&pinned.coefficients) {
            let value = fixed.unwrap_or(0.0);
            sum.iter_mut().zip(column).for_each(|(sum, c)| *sum += value * c);
        }
        Some(sum)
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        self.whole().symbolic(form)
    }

    fn formula_of(&self, form: &str) -> &str {
        self.whole().formula_of(form)
    }

    fn missing(&self, view: &View) -> Option<&'static str> {
        self.whole().missing(view)
    }

    fn same_as(&self, view: &View) -> Option<&'static str> {
        self.whole().same_as(view)
    }

    fn hidden(&self, view: &View) -> Option<String> {
        self.whole().hidden(view)
    }
}
