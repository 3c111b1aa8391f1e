//! Harmonics of which more than half a period passes for each sample, so that samples do not resolve them (Shannon
//! 1949).

use crate::linear::basis::Basis;
use crate::preprocess::design::segments::stretches;
use crate::regression::linear_model::LinearModel;
use std::f64::consts::PI;

/// Fewer rows in a stretch do not separate a wave from noise.
const FEWEST: usize = 10;

/// The residual of a steady-state model without the waves of its own effects where they pass too fast. The share of a
/// fast wave in the motor current depends on the inertia and the drive's control, not on the joint.
pub fn without_undersampled_harmonics(now: &LinearModel, mut residual: Vec<f64>) -> Vec<f64> {
    let view = &now.problem.view;
    for term in &now.terms {
        let Some(angle) = term.effect.traits().wave else { continue };
        let Some(samples) = view.samples.find(angle).filter(|_| !view.chunks.is_empty()) else { continue };
        for order in &term.shape {
            let columns = view.harmonic(angle, *order);
            for stretch in stretches(&now.problem.segment) {
                let chunks = &view.chunks[stretch.clone()];
                let way: f64 = chunks.iter().map(|c| (samples[c.end - 1] - samples[c.start]).abs()).sum();
                let steps: usize = chunks.iter().map(|c| c.len() - 1).sum();
                if stretch.len() >= FEWEST && order * way > PI * steps as f64 {
                    let waves = columns.iter().map(|c| c[stretch.clone()].to_vec()).collect::<Vec<_>>();
                    let rest = Basis::of(&waves).rest(&residual[stretch.clone()]);
                    residual[stretch].copy_from_slice(&rest);
                }
            }
        }
    }
    residual
}
