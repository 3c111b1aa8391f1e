//! Detection limits of effects that the evidence search did not find.

use crate::Options;
use crate::effect::Regime;
use crate::linear::blocked_ridge::BlockedRidge;
use crate::preprocess::form_error::FormErrorKind;
use crate::regression::candidates::{CandidateSet, Regressor};
use crate::regression::evidence::visible;
use crate::regression::solution::{Solution, effect_coefficient, without};
use crate::regression::two_stage_model::TwoStageModel;
use crate::selection::detection_limit::DetectionLimit;
use crate::selection::evidence_search::rules::error_reduction::least_gain;
use crate::stats::student;
use crate::stats::summary::quantile;
use crate::thresholds::{DELAY_ROWS, DETECTION_POWER};
use rayon::prelude::*;

/// Detection limit of each effect that is not in the model: the smallest size that is found with 80 % power, as the
/// median over the forms of the effect.
pub fn detection_limits<'p>(
    end: &TwoStageModel<'p>,
    solution: &Solution,
    library: &CandidateSet<'p>,
    options: &Options,
) -> Vec<DetectionLimit<'p>> {
    let is_out = |id: &str| !end.effects.iter().any(|e| e == id);
    let open: Vec<&Regressor<'p>> = library.candidates.iter().filter(|c| is_out(c.id())).collect();
    let blocks = solution.ridge.blocks.len() as f64;
    let chance = options.alpha / (2.0 * open.len().max(1) as f64);
    let critical = student::quantile(blocks - 1.0, 1.0 - chance).unwrap_or(3.0);
    let without_jerk = without(&end.main, solution, FormErrorKind::Jerk);
    let without_bristle = without(&end.main, solution, FormErrorKind::Bristle);
    let size = |form: &&Regressor<'p>| {
        let ridge = match form.effect.traits().regime {
            Regime::Hysteresis => &without_bristle,
            _ if form.effect.traits().delay_of.is_some() => &without_jerk,
            _ => &solution.ridge,
        };
        Some((form.id(), smallest(form, ridge, critical, end, solution)?))
    };
    let sizes: Vec<(&'p str, f64)> = open.par_iter().filter_map(size).collect();
    let of_effect = |forms: &[(&'p str, f64)]| DetectionLimit {
        effect: forms[0].0,
        detectable_rms: quantile(forms.iter().map(|f| f.1), 0.5),
    };
    sizes.chunk_by(|a, b| a.0 == b.0).map(of_effect).collect()
}

/// RMS of the smallest effect of this form that is found.
fn smallest(
    form: &Regressor,
    ridge: &BlockedRidge,
    critical: f64,
    end: &TwoStageModel,
    solution: &Solution,
) -> Option<f64> {
    let added = visible(ridge, form)?;
    let scatter = added.scatter(&added.coefficients());
    // Form error imitates effects of transients.
    let share = least_gain(form.effect.traits().regime != Regime::SteadyState);
    let least = share / (1.0 - share) * ridge.loss();
    let least_delay = |of: &str| {
        let form_error = end.main.problem.form_error.as_deref()?;
        Some(effect_coefficient(&end.main, solution, of)?.abs() * DELAY_ROWS * form_error.sample_s)
    };
    let bound = match form.effect.traits().delay_of {
        Some(of) => least_delay(of)?,
        None => 0.0,
    };
    let k = added.size;
    let of_column = |(at, square): (usize, f64)| {
        let error = scatter[at * k + at].sqrt() / square;
        let coefficient = (critical * error).max((least / square).sqrt()).max(bound) + DETECTION_POWER * error;
        let column = &form.columns[at];
        let square = column.iter().map(|v| f64::from(*v).powi(2)).sum::<f64>() / column.len().max(1) as f64;
        coefficient * square.sqrt()
    };
    added.squares().enumerate().map(of_column).reduce(f64::min).filter(|rms| rms.is_finite())
}
