//! Points and curves of a plot.

use crate::identification::{Mark, Series};

pub(crate) fn scatter(label: &str, points: impl IntoIterator<Item = (f64, f64)>) -> Series {
    let (x, y) = points.into_iter().unzip();
    Series::new(label, Mark::Points, x, y)
}

/// A line through `steps` + 1 points from end to end. The last point is exactly the end, because a rounding error
/// beyond it could make a power of a negative number NaN.
pub(crate) fn curve(label: &str, [from, to]: [f64; 2], steps: u32, y: impl Fn(f64) -> f64) -> Series {
    let x: Vec<f64> = (0..=steps).map(|i| from + (to - from) * (f64::from(i) / f64::from(steps))).collect();
    let y = x.iter().map(|x| y(*x)).collect();
    Series::new(label, Mark::Line, x, y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_ends_at_its_given_end() {
        for i in 0..1000 {
            let top = 160.0 + f64::from(i) * 0.0137;
            let drawn = curve("model, negative", [-top, 0.0], 200, |v| (-v).powf(0.8));
            assert!(drawn.x.last() == Some(&0.0) && drawn.y.iter().all(|y| y.is_finite()), "from {top}");
        }
    }
}
