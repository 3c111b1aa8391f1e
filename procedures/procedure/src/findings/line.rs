//! A straight line through means, with the intervals of its two parameters.

use super::solve::t95;
use jointbench_model::stats::student;

/// y = offset + slope·x by least squares over points of equal weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    pub offset: f64,
    pub slope: f64,
    pub offset_ci95: [f64; 2],
    pub slope_ci95: [f64; 2],
    /// Share of the scatter of y that the line explains.
    pub r2: f64,
}

/// A mean with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mean {
    pub value: f64,
    pub ci95: [f64; 2],
}

impl Mean {
    /// `None` below two values.
    pub fn of(values: &[f64]) -> Option<Self> {
        let n = values.len() as f64;
        let t = student::t95(n - 1.0)?;
        let value = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - value).powi(2)).sum::<f64>() / (n - 1.0);
        let reach = t * (variance / n).sqrt();
        Some(Self { value, ci95: [value - reach, value + reach] })
    }
}

impl Line {
    /// `None` below three points, or if all have the same x.
    pub fn through(points: &[(f64, f64)]) -> Option<Self> {
        let n = points.len() as f64;
        let mean = |pick: fn(&(f64, f64)) -> f64| points.iter().map(pick).sum::<f64>() / n;
        let (x0, y0) = (mean(|p| p.0), mean(|p| p.1));
        let sum = |f: &dyn Fn(f64, f64) -> f64| points.iter().map(|(x, y)| f(x - x0, y - y0)).sum::<f64>();
        let (xx, xy, yy) = (sum(&|x, _| x * x), sum(&|x, y| x * y), sum(&|_, y| y * y));
        if points.len() < 3 || xx <= f64::EPSILON * x0 * x0 {
            return None;
        }
        let slope = xy / xx;
        let offset = y0 - slope * x0;
        let left = sum(&|x, y| (y - slope * x).powi(2));
        let variance = left / (n - 2.0);
        let t = t95(n - 2.0);
        let around = |value: f64, share: f64| {
            let reach = t * (variance * share).sqrt();
            [value - reach, value + reach]
        };
        Some(Self {
            offset,
            slope,
            offset_ci95: around(offset, 1.0 / n + x0 * x0 / xx),
            slope_ci95: around(slope, 1.0 / xx),
            r2: if yy > 0.0 { 1.0 - left / yy } else { 1.0 },
        })
    }

    pub fn at(&self, x: f64) -> f64 {
        self.offset + self.slope * x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The five points of a textbook example (Anscombe's mean and slope are exact here: y = 1 + 2x with ±0.1).
    #[test]
    fn a_line_is_found_with_its_interval() {
        let points = [(0.0, 1.1), (1.0, 2.9), (2.0, 5.1), (3.0, 6.9), (4.0, 9.0)];
        let line = Line::through(&points).unwrap();
        assert!((line.slope - 1.98).abs() < 1e-12 && (line.offset - 1.04).abs() < 1e-12, "{line:?}");
        // s² = 0.0720 / 3… the standard error of the slope is s/√10, Student's t at three degrees of freedom 3.182.
        let left: f64 = points.iter().map(|(x, y)| (y - line.at(*x)).powi(2)).sum();
        let reach = 3.182_446 * (left / 3.0 / 10.0).sqrt();
        assert!((line.slope_ci95[1] - line.slope - reach).abs() < 1e-5);
        assert!(line.r2 > 0.99);
    }

    #[test]
    fn two_points_or_one_place_are_no_line() {
        assert_eq!(Line::through(&[(0.0, 1.0), (1.0, 2.0)]), None);
        assert_eq!(Line::through(&[(2.0, 1.0), (2.0, 2.0), (2.0, 3.0)]), None);
    }
}
