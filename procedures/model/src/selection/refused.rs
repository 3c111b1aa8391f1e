//! What the evidence leaves: structure, and effects that take much and are not named.

use crate::effect::{Effect, Regime};
use crate::regression::evidence::{Evidence, ONE_ERROR};
use crate::residual_analysis::structure::Left;
use crate::thresholds::{DECISION_SHARE, UNMISTAKABLE_SHARE};
use crate::words::percent;

/// What the decision leaves.
pub struct Decided<'p> {
    /// Structure that no effect takes.
    pub left: Option<Left>,
    pub refused: Vec<Refused<'p>>,
}

/// An effect that takes much, and was not named.
pub struct Refused<'p> {
    pub effect: &'p str,
    pub gain: f64,
    pub p_value: f64,
    pub alpha: f64,
    pub errors: f64,
    /// What it would have to take.
    pub least: f64,
}

impl<'p> Refused<'p> {
    pub fn of(evidence: &Evidence<'_, 'p>, alpha: f64) -> Self {
        Self {
            effect: evidence.best.id(),
            gain: evidence.gain,
            p_value: evidence.p_value,
            alpha,
            errors: evidence.errors,
            least: least_share(evidence.best.effect),
        }
    }

    /// What it takes, and why it is not named, in words.
    pub fn why(&self) -> String {
        let takes =
            format!("it would take {} off the squared error of data that had no part in its fit", percent(self.gain));
        match () {
            () if self.p_value >= self.alpha => {
                format!("{takes}, which chance does with a probability of {:.2}", self.p_value)
            }
            () if self.errors <= ONE_ERROR => format!("{takes}, in a few stretches of the run alone"),
            () if self.gain <= self.least => format!(
                "{takes}, and shows only around reversals and on ramps, where every formula errs: there it takes {} to name it",
                percent(self.least)
            ),
            () => format!("{takes}, beside as many effects as are added at most"),
        }
    }
}

/// What shows only where all formulas err has to take most of what is left.
pub fn least_share(effect: &dyn Effect) -> f64 {
    match effect.regime() {
        Regime::SteadyState => DECISION_SHARE,
        _ => UNMISTAKABLE_SHARE,
    }
}
