//! Lack of fit: what is left over an axis, and whether it is more than whole stretches of motion scatter by.

use crate::Options;
use crate::preprocess::Prepared;
use crate::preprocess::design::segments::stretches;
use crate::preprocess::independent_blocks::{legs, pieces};
use crate::regression::linear_model::LinearModel;
use crate::report::diagnosis::NoiseFloor;
use crate::residual_analysis::maps::Maps;
use crate::residual_analysis::random_walk_offset::Ar1Offset;
use crate::stats::grouped::within;
use crate::thresholds::STRUCTURE_SHARE;

/// The axis over which structure remains.
pub fn structured(maps: &Maps) -> Option<&str> {
    maps.removable().filter(|(_, share)| *share > STRUCTURE_SHARE).map(|(axis, _)| axis)
}

/// What shows over an axis is what whole stretches of motion differ by, a zero that wanders or lies elsewhere after every
/// reversal: little of it comes again for sure in another repeat, and no part of any axis stands out of that scatter.
pub fn is_scatter(
    now: &LinearModel,
    maps: &Maps,
    residual: &[f64],
    floor: &NoiseFloor,
    prepared: &Prepared,
    options: &Options,
) -> bool {
    let surely = floor.repeatable_ci95.is_none_or(|[least, _]| least > 0.0);
    let comes_again = floor.repeatable_share.is_none_or(|share| share > STRUCTURE_SHARE) && surely;
    if structured(maps).is_none() || comes_again {
        return false;
    }
    let is_known = floor.ci95.is_some();
    match Ar1Offset::of(now, options) {
        Some(wander) => only_wanders(&wander, residual, prepared, options) || is_known && !maps.stand_out(),
        None => is_known && !(maps.stand_out_beside_time() && stands_out_within_legs(residual, prepared, options)),
    }
}

/// Nothing shows over any axis but a zero that wanders over time: a little everywhere, and no figure of the model leaps.
fn only_wanders(wander: &Ar1Offset, residual: &[f64], prepared: &Prepared, options: &Options) -> bool {
    let beside = Maps::new(prepared, wander.taken_off(residual), options);
    structured(&beside).is_none() && !beside.stand_out() && !wander.is_heavy_tailed() && !wander.leaps(options)
}

/// Where legs are too few to tell what they scatter by, some part of an axis stands out within them, each with a zero of its own.
fn stands_out_within_legs(residual: &[f64], prepared: &Prepared, options: &Options) -> bool {
    let problem = &prepared.main;
    let leg = legs(problem);
    if pieces(problem, 1).0 == leg {
        return true;
    }
    Maps::new(prepared, within(residual, &stretches(&leg)), options).stand_out_beside_time()
}
