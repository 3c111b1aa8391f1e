//! Lack of fit: structure of the residual over an axis, compared with the scatter of whole stretches of motion.

use crate::Options;
use crate::preprocess::Prepared;
use crate::preprocess::design::segments::stretches;
use crate::preprocess::independent_blocks::{independent_blocks, legs};
use crate::regression::linear_model::LinearModel;
use crate::report::diagnosis::NoiseFloor;
use crate::residual_analysis::maps::Maps;
use crate::residual_analysis::random_walk_offset::Ar1Offset;
use crate::stats::grouped::within;
use crate::thresholds::LEFT_SHARE;

/// The axis over which structure remains.
pub fn structured(maps: &Maps) -> Option<&str> {
    maps.explained_share().filter(|(_, share)| *share > LEFT_SHARE).map(|(axis, _)| axis)
}

/// Whether the structure over an axis is only scatter between stretches of motion, such as an offset that drifts or
/// changes after every reversal. Then little of it is repeatable, and no part of an axis exceeds that scatter.
pub fn is_scatter(
    now: &LinearModel,
    maps: &Maps,
    residual: &[f64],
    floor: &NoiseFloor,
    prepared: &Prepared,
    options: &Options,
) -> bool {
    let surely = floor.repeatable_ci95.is_none_or(|[least, _]| least > 0.0);
    let recurs = floor.repeatable_share.is_none_or(|share| share > LEFT_SHARE) && surely;
    if structured(maps).is_none() || recurs {
        return false;
    }
    let is_known = floor.ci95.is_some();
    match Ar1Offset::of(now, options) {
        Some(random_walk) => {
            is_random_walk_only(&random_walk, residual, prepared, options) || is_known && !maps.is_significant()
        }
        None => {
            is_known && !(maps.is_significant_beyond_time() && is_significant_within_legs(residual, prepared, options))
        }
    }
}

/// Whether a random-walk offset explains all structure: no axis shows structure without it, its innovations are not
/// heavy-tailed, and no coefficient has a changepoint.
fn is_random_walk_only(random_walk: &Ar1Offset, residual: &[f64], prepared: &Prepared, options: &Options) -> bool {
    let remaining = Maps::new(prepared, random_walk.without_offset(residual), options);
    structured(&remaining).is_none()
        && !remaining.is_significant()
        && !random_walk.is_heavy_tailed()
        && !random_walk.has_changepoint(options)
}

/// Whether a part of an axis is significant within legs, with a separate offset for each. The test only applies with
/// too few legs to estimate their scatter; otherwise the result is true.
fn is_significant_within_legs(residual: &[f64], prepared: &Prepared, options: &Options) -> bool {
    let problem = &prepared.main;
    let leg = legs(problem);
    if independent_blocks(problem, 1).0 == leg {
        return true;
    }
    Maps::new(prepared, within(residual, &stretches(&leg)), options).is_significant_beyond_time()
}
