//! Effects that scale the whole torque that current and history explain.
//!
//! They are relative to the usual value of their signal. Otherwise such an effect would contain the torque itself: a
//! nearly constant temperature times the torque imitates a missing curve or hysteresis.

use crate::effect::{Form, Shape, ShapeSearch};
use crate::signal::Signal;
use crate::view::View;

/// Why a controller cannot compute such an effect.
pub const NOT_IN_A_CONTROLLER: &str =
    "it grows with the torque that current and history explain, which is known for a recording only";

/// The usual value of a signal while the brake holds: its mean, weighted with the squared torque.
pub fn usual(view: &View, signal: Signal, of: impl Fn(f64) -> f64) -> f64 {
    let weights = view.get(Signal::Drive).iter().map(|d| d * d);
    let (sum, all) = view.get(signal).iter().zip(weights).fold((0.0, 0.0), |(s, a), (x, w)| (s + of(*x) * w, a + w));
    if all > 0.0 { sum / all } else { 0.0 }
}

/// The usual value is stored with the fit, because another run has another one.
pub fn form<'e>(coefficient: &'e str, origin: &'e str, usual: f64) -> Form<'e> {
    // Fixed; `Signed`, because a temperature may be negative.
    let shape = vec![Shape { name: origin, min: usual, max: usual, search: ShapeSearch::Signed }];
    Form { name: "scaled", linear: vec![coefficient], shape, grid: vec![vec![usual]] }
}
