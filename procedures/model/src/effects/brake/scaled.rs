//! What scales the whole torque that current and history explain.
//!
//! From where it usually is, or it would bring that torque along: a temperature that hardly changes, times the torque, is
//! curve and hysteresis, whichever of them a model lacks.

use crate::effect::{Form, Shape, ShapeSearch};
use crate::signal::Signal;
use crate::view::View;

/// What a signal usually is where the brake holds: its mean over the squared torque.
pub fn usual(view: &View, signal: Signal, of: impl Fn(f64) -> f64) -> f64 {
    let weights = view.get(Signal::Drive).iter().map(|d| d * d);
    let (sum, all) = view.get(signal).iter().zip(weights).fold((0.0, 0.0), |(s, a), (x, w)| (s + of(*x) * w, a + w));
    if all > 0.0 { sum / all } else { 0.0 }
}

/// It belongs to the fit: another run is usually elsewhere.
pub fn form<'e>(factor: &'e str, origin: &'e str, usual: f64) -> Form<'e> {
    // Held where it is; a temperature may be below zero.
    let shape = vec![Shape { name: origin, min: usual, max: usual, search: ShapeSearch::Signed }];
    Form { name: "scaled", linear: vec![factor], shape, grid: vec![vec![usual]] }
}
