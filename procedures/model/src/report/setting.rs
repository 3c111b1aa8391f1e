//! What a user sets for a parameter of a model.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A fixed value, bounds or a start value of one parameter, in the unit of the parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ParameterSetting {
    /// Id of an effect of the model.
    pub effect: String,
    /// Name within the effect: `tau_c`.
    pub name: String,
    /// The value, which is not fitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fixed: Option<f64>,
    /// Smallest value that the fit may find.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// Largest value that the fit may find.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// Start value of the search for a nonlinear parameter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<f64>,
}

impl ParameterSetting {
    /// Why no fit can follow the setting, for a parameter with these physical bounds.
    pub(crate) fn check(&self, physical: (f64, f64)) -> Result<(), String> {
        let named = [("fixed", self.fixed), ("min", self.min), ("max", self.max), ("start", self.start)];
        let mut given = named.into_iter().filter_map(|(name, value)| value.map(|value| (name, value))).peekable();
        if given.peek().is_none() {
            return Err("nothing is set; give fixed, min, max or start".into());
        }
        for (name, value) in given {
            if !value.is_finite() {
                return Err(format!("{name} is not a finite number"));
            }
        }
        let (min, max) = (self.min.unwrap_or(f64::NEG_INFINITY), self.max.unwrap_or(f64::INFINITY));
        if min > max {
            return Err(format!("min {min} is larger than max {max}"));
        }
        for (name, value) in [("fixed", self.fixed), ("start", self.start)] {
            let Some(value) = value else { continue };
            if !(min..=max).contains(&value) {
                return Err(format!("{name} {value} is outside its bounds ({})", range(min, max)));
            }
            if !(physical.0..=physical.1).contains(&value) {
                return Err(format!(
                    "{name} {value} is outside its physical range ({})",
                    range(physical.0, physical.1)
                ));
            }
        }
        if min > physical.1 || max < physical.0 {
            let range = range(physical.0, physical.1);
            return Err(format!("its bounds are outside its physical range ({range})"));
        }
        if self.fixed.is_some() && self.start.is_some() {
            return Err("a fixed value has no search and no start value; give one of both".into());
        }
        Ok(())
    }

    /// The nearest value within the bounds.
    pub(crate) fn nearest(&self, value: f64) -> f64 {
        value.max(self.min.unwrap_or(f64::NEG_INFINITY)).min(self.max.unwrap_or(f64::INFINITY))
    }
}

fn range(min: f64, max: f64) -> String {
    match (min.is_finite(), max.is_finite()) {
        (true, true) => format!("{min} to {max}"),
        (true, false) => format!("at least {min}"),
        _ => format!("at most {max}"),
    }
}
