//! Evidence for an effect: the reduction of the validation error, on data that was not used to choose its form and
//! coefficients.

use crate::effect::Regime;
use crate::linear::added_columns::{Added, Gain};
use crate::linear::blocked_ridge::{BlockedRidge, Outside};
use crate::regression::candidates::Regressor;
use crate::regression::linear_model::allows;
use crate::regression::partial_regression::LEAST_TOLERANCE;
use crate::stats::{student, summary};
use crate::thresholds::DECISION_SHARE;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// The evidence for one candidate effect.
pub struct Evidence<'l, 'p> {
    /// The form that explains most of the whole run.
    pub best: &'l Regressor<'p>,
    /// Error reduction: share of the squared validation error that the effect explains.
    pub gain: f64,
    /// The error reduction in units of its standard error over blocks.
    pub errors: f64,
    /// p-value, corrected for all forms of the library (Bonferroni).
    pub p_value: f64,
    /// Squared validation error of each block with the effect.
    pub losses: Vec<f64>,
    /// Form error of the model could explain the same: it is left out of the base for this candidate, or the candidate
    /// shows only at reversals, where form error lives.
    pub form_error_imitates: bool,
    /// It was compared with a base without the form error that represents the same effect.
    pub is_without_form_error: bool,
}

impl Evidence<'_, '_> {
    pub fn id(&self) -> &str {
        self.best.id()
    }
}

/// Result of one form added to the base model.
enum Tried<'l, 'p> {
    Judged(Trial<'l, 'p>),
    /// It does not show outside reversals, or its coefficients are physically impossible.
    Rejected,
    /// It is collinear with the base model.
    Hidden(&'l Regressor<'p>),
}

struct Trial<'l, 'p> {
    form: &'l Regressor<'p>,
    taken: f64,
    gains: Vec<Gain>,
    chance: f64,
    shows_outside: bool,
}

/// The evidence for each candidate effect, by decreasing error reduction, and the forms that are collinear with the
/// base model. `forms` is the number of tested forms.
///
/// A candidate shows outside reversals and rests if it reaches the practical share on the rows that are not `near` one,
/// with the model fitted to these rows alone. A steady-state effect has to, unless it is a wave over an angle; a form that
/// differs from the model only at reversals does not.
pub fn evidence<'l, 'p>(
    ridge: &BlockedRidge,
    candidates: &[&'l Regressor<'p>],
    near: &[bool],
    forms: usize,
) -> (Vec<Evidence<'l, 'p>>, Vec<&'l Regressor<'p>>) {
    let outside = ridge.outside(near);
    let tried: Vec<Tried> = candidates.par_iter().map(|form| attempt(ridge, form, outside.as_ref())).collect();
    let (mut trials, mut hidden) = (Vec::new(), Vec::new());
    for tried in tried {
        match tried {
            Tried::Judged(trial) => trials.push(trial),
            Tried::Rejected => {}
            Tried::Hidden(form) => hidden.push(form),
        }
    }
    let mut all: Vec<Evidence> = trials
        .chunk_by(|a, b| a.form.id() == b.form.id())
        .filter_map(|forms_of_one| of_effect(ridge, forms_of_one, forms))
        .collect();
    all.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    (all, hidden)
}

fn attempt<'l, 'p>(ridge: &BlockedRidge, form: &'l Regressor<'p>, outside: Option<&Outside>) -> Tried<'l, 'p> {
    let Some(added) = visible(ridge, form) else { return Tried::Hidden(form) };
    let is_possible = |coefficients: &[f64]| allows(form.effect, &form.form, coefficients);
    if !is_possible(&added.coefficients()) {
        return Tried::Rejected;
    }
    // Form error is a function of the time since a reversal, not of an angle: a wave has to exceed it, but need not show
    // elsewhere.
    let traits = form.effect.traits();
    let has_to = traits.regime == Regime::SteadyState && traits.wave.is_none();
    let shows_outside = match outside.map(|outside| (outside.left(), outside.added(&form.columns, LEAST_TOLERANCE))) {
        None => traits.regime == Regime::SteadyState,
        Some((_, None)) if has_to => return Tried::Hidden(form),
        Some((_, None)) => false,
        Some((left, Some((coefficients, taken)))) => is_possible(&coefficients) && taken > DECISION_SHARE * left,
    };
    if has_to && !shows_outside {
        return Tried::Rejected;
    }
    let chance = chance(added.wald(), added.size, ridge.blocks.len());
    let gains = added.gains(0.0, is_possible);
    Tried::Judged(Trial { form, taken: added.taken(), gains, chance, shows_outside })
}

/// The regression with this form added, unless the form is collinear with the model.
pub fn visible(ridge: &BlockedRidge, form: &Regressor) -> Option<Added> {
    let added = Added::new(ridge, &form.columns);
    (added.visible > LEAST_TOLERANCE).then_some(added)
}

/// The form for each block is chosen on the other blocks, so that the choice does not bias the validation error.
fn of_effect<'l, 'p>(ridge: &BlockedRidge, trials: &[Trial<'l, 'p>], forms: usize) -> Option<Evidence<'l, 'p>> {
    let best = trials.iter().max_by(|a, b| a.taken.total_cmp(&b.taken))?;
    let of_block = |block: usize| {
        let chosen = trials.iter().map(|t| t.gains[block]).max_by(|a, b| a.fitted.total_cmp(&b.fitted));
        chosen.map_or(0.0, |gain| gain.validation_losses)
    };
    let gains: Vec<f64> = (0..ridge.blocks.len()).map(of_block).collect();
    Some(Evidence {
        best: best.form,
        gain: gains.iter().sum::<f64>() / ridge.loss().max(f64::MIN_POSITIVE),
        errors: errors(&gains),
        p_value: (best.chance * forms as f64).min(1.0),
        losses: ridge.losses.iter().zip(&gains).map(|(loss, gain)| loss - gain).collect(),
        form_error_imitates: !best.shows_outside,
        is_without_form_error: false,
    })
}

/// A mean in units of its standard error.
pub fn errors(values: &[f64]) -> f64 {
    summary::mean(values) / summary::standard_error(values).max(f64::MIN_POSITIVE)
}

/// p-value of a Wald statistic with this number of coefficients, estimated from this number of blocks: Student's t
/// for one coefficient, Hotelling's T² for several.
pub fn chance(wald: f64, coefficients: usize, blocks: usize) -> f64 {
    let (k, g) = (coefficients as f64, blocks as f64);
    match coefficients {
        1 => student::p_value(g - 1.0, wald.max(0.0).sqrt()).unwrap_or(1.0),
        _ => {
            let law = FisherSnedecor::new(k, (g - k).max(1.0));
            law.map_or(1.0, |law| law.sf(wald.max(0.0) * (g - k) / ((g - 1.0) * k)))
        }
    }
}
