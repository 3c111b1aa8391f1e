//! An effect is named only where it explains more than the formulas of the other effects may leave.

use crate::Options;
use crate::thresholds::{FORMULA_ERROR, UNMISTAKABLE_SHARE};
use jointbench_instrument::Kind;

/// What an effect must explain to be worth a name.
#[derive(Clone, Copy)]
pub struct AcceptanceThreshold<'l> {
    /// Squared error of the baseline, with what formulas explain that are exact.
    pub plain: f64,
    pub kind: Kind,
    pub options: &'l Options,
}

/// No formula fits nature better than to this share of what it explains, squared (4.5 % in RMS). But an encoder's errors
/// are waves over its own angle, steps and slopes: their formulas are no approximations.
fn form_error(kind: Kind) -> f64 {
    if kind == Kind::Encoder { 0.0 } else { FORMULA_ERROR }
}

impl AcceptanceThreshold<'_> {
    /// The least share of the squared error `energy` that an effect must take beside a model: what the formulas of its
    /// effects may leave is none.
    pub fn least_share(&self, energy: f64) -> f64 {
        let remainder = form_error(self.kind) * (self.plain - energy).max(0.0);
        self.options.practical_share.max((remainder / energy).min(UNMISTAKABLE_SHARE))
    }
}
