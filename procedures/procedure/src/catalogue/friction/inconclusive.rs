//! Open questions of a friction run: a Stribeck rise below the detection limit, and scatter that speed does not
//! explain.

use super::free_friction::{FreeFriction, friction_nm};
use crate::findings::{Plateau, solve};
use crate::identification::Direction;
use crate::thresholds::{EXPLAINED, SMALL_REST, SMALL_RISE};
use jointbench_model::words;

/// Tested Stribeck velocities relative to the expected one.
const WHERE_IT_RISES: [f64; 3] = [0.5, 1.0, 2.0];
/// The largest rise or fall at low speed that is compatible with the points at 95 %. The directions may differ.
pub(super) fn hidden_rise_nm(points: &[Plateau], expected_rad_s: f64) -> Option<f64> {
    let values: Vec<f64> = points.iter().map(|p| friction_nm(p) * p.velocity_rad_s.signum()).collect();
    let of_width = |share: f64| {
        let row = |p: &Plateau| {
            let (way, speed) = (p.velocity_rad_s.signum(), p.velocity_rad_s.abs());
            [1.0, way, speed, way * speed, (-speed / (share * expected_rad_s)).exp()]
        };
        let [low, high] = solve(&points.iter().map(row).collect::<Vec<_>>(), &values)?.ci95(4);
        Some(high.max(-low))
    };
    WHERE_IT_RISES.into_iter().try_fold(0.0, |most: f64, share| Some(most.max(of_width(share)?)))
}

/// Whether a rise of this size is negligible.
pub(super) fn is_small(rise_nm: f64, whole: &FreeFriction) -> bool {
    rise_nm <= SMALL_RISE * whole.coulomb.0
}

/// Quality of the separate fit of one direction.
pub(super) struct Side {
    /// Share of the scatter explained.
    pub r2: f64,
    rest_rms_nm: f64,
}

impl Side {
    pub fn of(points: &[Plateau], sign: f64, curve: &FreeFriction) -> Self {
        let points: Vec<&Plateau> = points.iter().filter(|p| p.velocity_rad_s * sign > 0.0).collect();
        let count = points.len() as f64;
        let mean = points.iter().map(|p| friction_nm(p)).sum::<f64>() / count;
        let (mut left, mut all) = (0.0, 0.0);
        for point in points {
            left += (friction_nm(point) - sign * curve.at(point.velocity_rad_s.abs())).powi(2);
            all += (friction_nm(point) - mean).powi(2);
        }
        Self { r2: 1.0 - left / all, rest_rms_nm: (left / count).sqrt() }
    }
}

/// A dependence on something other than speed, in a separate sentence.
pub(super) fn rest(sides: &[(Direction, Side); 2], whole: &FreeFriction) -> Option<String> {
    let open = |side: &Side| side.r2 < EXPLAINED && side.rest_rms_nm > SMALL_REST * whole.coulomb.0;
    let (direction, side) =
        sides.iter().filter(|(_, side)| open(side)).max_by(|a, b| a.1.rest_rms_nm.total_cmp(&b.1.rest_rms_nm))?;
    Some(format!(
        "In the {} direction speed explains only {} of the friction variance (residual {} RMS, {} of Coulomb \
         friction).",
        direction.word(),
        words::percent(side.r2.max(0.0)),
        words::figure(side.rest_rms_nm, "Nm"),
        words::percent(side.rest_rms_nm / whole.coulomb.0)
    ))
}
