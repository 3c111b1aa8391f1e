//! Curves through measured or assumed points, with linear interpolation.

/// The curve at `x`, with linear extrapolation beyond its ends.
pub fn at(curve: &[(f64, f64)], x: f64) -> f64 {
    let upper = curve.partition_point(|(knot, _)| *knot < x).clamp(1, curve.len() - 1);
    let ((x0, y0), (x1, y1)) = (curve[upper - 1], curve[upper]);
    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}
