//! Curves that were measured or assumed at points, straight between them.

/// The curve at `x`; beyond its ends it goes on as it ended.
pub fn at(curve: &[(f64, f64)], x: f64) -> f64 {
    let upper = curve.partition_point(|(knot, _)| *knot < x).clamp(1, curve.len() - 1);
    let ((x0, y0), (x1, y1)) = (curve[upper - 1], curve[upper]);
    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}
