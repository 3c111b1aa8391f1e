//! Plots as SVG: values with intervals, and histograms.

use std::fmt::Write as _;

/// Width of a plot [px].
const WIDTH: f64 = 720.0;
/// Space for labels on the left [px].
const LEFT: f64 = 190.0;
/// Space on the right [px].
const RIGHT: f64 = 30.0;
/// Height of a row of values with intervals [px].
const ROW: f64 = 24.0;
/// Height of a histogram without its axis [px].
const TALL: f64 = 150.0;
/// Height of an axis with its label [px].
const AXIS: f64 = 44.0;
/// Intervals between ticks of an axis, at most.
const TICKS: usize = 5;

/// A value with its interval.
pub struct Interval {
    /// Text on the left.
    pub label: String,
    /// The value.
    pub value: f64,
    /// The interval.
    pub ends: [f64; 2],
    /// Whether it has the second colour.
    pub is_marked: bool,
}

/// A text without the characters that HTML interprets.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A linear axis over a range of values.
struct Axis {
    low: f64,
    high: f64,
}

impl Axis {
    fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let (low, high) = values
            .filter(|v| v.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let margin = if high > low { 0.0 } else { 0.5 * high.abs().max(1e-12) };
        (low <= high).then_some(Self { low: low - margin, high: high + margin })
    }

    fn x(&self, value: f64) -> f64 {
        let share = ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0);
        LEFT + share * (WIDTH - LEFT - RIGHT)
    }

    /// Round values: multiples of 1, 2 or 5 times a power of ten.
    fn ticks(&self) -> Vec<f64> {
        let least = (self.high - self.low) / TICKS as f64;
        let power = 10f64.powf(least.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power).into_iter().find(|step| *step >= 0.999 * least);
        let step = step.unwrap_or(least);
        let (first, last) = ((self.low / step - 1e-9).ceil() as i64, (self.high / step + 1e-9).floor() as i64);
        (first..=last).map(|tick| tick as f64 * step).collect()
    }

    /// The axis below a plot of this height.
    fn draw(&self, top: f64, label: &str, number: impl Fn(f64) -> String) -> String {
        let mut svg = format!("<path class=\"axis\" d=\"M{LEFT} {top}H{}\"/>", WIDTH - RIGHT);
        for value in self.ticks() {
            let (x, number) = (self.x(value), number(value));
            let _ = write!(
                svg,
                "<path class=\"axis\" d=\"M{x:.1} {top}v4\"/><text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{number}</text>",
                top + 16.0
            );
        }
        let middle = 0.5 * (LEFT + WIDTH - RIGHT);
        let (y, label) = (top + 34.0, escaped(label));
        let _ = write!(svg, "<text x=\"{middle}\" y=\"{y}\" text-anchor=\"middle\">{label}</text>");
        svg
    }
}

fn figure(height: f64, title: &str, content: &str) -> String {
    let title = escaped(title);
    format!(
        "<figure><figcaption>{title}</figcaption><svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"{title}\">\
         {content}</svg></figure>\n"
    )
}

/// One row for each value, on a common axis that begins at `from`, if it is given. Empty without values.
pub fn intervals(
    title: &str,
    label: &str,
    rows: &[Interval],
    from: Option<f64>,
    number: impl Fn(f64) -> String,
) -> String {
    let ends = rows.iter().flat_map(|row| row.ends.into_iter().chain([row.value]));
    let Some(axis) = Axis::of(ends.chain(from)) else { return String::new() };
    let mut svg = String::new();
    for (at, row) in rows.iter().enumerate() {
        let y = ROW * (at as f64 + 0.5);
        let class = if row.is_marked { "marked" } else { "plain" };
        let [low, high] = row.ends.map(|end| axis.x(end));
        let (x, label) = (axis.x(row.value), escaped(&row.label));
        let _ = write!(
            svg,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{label}</text><path class=\"{class}\" d=\"M{low:.1} {y}H{high:.1}\"/>\
             <circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y}\" r=\"4\"/>",
            LEFT - 10.0,
            y + 4.0
        );
    }
    let height = ROW * rows.len() as f64;
    figure(height + AXIS, title, &(svg + &axis.draw(height, label, number)))
}

/// The distribution of values in bins of equal width, from quartile to quartile by the rule of Freedman and Diaconis
/// (1981). Empty without values.
pub fn histogram(title: &str, label: &str, values: &[f64], number: impl Fn(f64) -> String) -> String {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let Some(axis) = Axis::of(sorted.iter().copied()) else { return String::new() };
    let counts = counts(&sorted, &axis);
    let highest = counts.iter().copied().max().unwrap_or(1).max(1) as f64;
    let mut svg = String::new();
    for (bin, count) in counts.iter().enumerate() {
        let edge = |bin: usize| axis.x(axis.low + (axis.high - axis.low) * bin as f64 / counts.len() as f64);
        let height = (TALL - 10.0) * *count as f64 / highest;
        let _ = write!(
            svg,
            "<rect class=\"bin\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{height:.1}\"/>",
            edge(bin),
            TALL - height,
            (edge(bin + 1) - edge(bin) - 1.0).max(0.5)
        );
    }
    let _ = write!(svg, "<text x=\"{}\" y=\"14\" text-anchor=\"end\">{highest} units</text>", LEFT - 10.0);
    figure(TALL + AXIS, title, &(svg + &axis.draw(TALL, label, number)))
}

fn counts(sorted: &[f64], axis: &Axis) -> Vec<usize> {
    const MOST: f64 = 60.0;
    let n = sorted.len();
    let quartile = |share: f64| sorted[(share * (n - 1) as f64) as usize];
    let width = 2.0 * (quartile(0.75) - quartile(0.25)) / (n as f64).cbrt();
    let range = axis.high - axis.low;
    let bins = if width > 0.0 { (range / width).ceil().clamp(1.0, MOST) } else { 1.0 };
    let mut counts = vec![0; bins as usize];
    for value in sorted {
        let bin = ((value - axis.low) / range * bins) as usize;
        counts[bin.min(bins as usize - 1)] += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_in_one_bin() {
        let values: Vec<f64> = (0..500).map(|i| f64::from(i * i % 97)).collect();
        let mut sorted = values.clone();
        sorted.sort_by(f64::total_cmp);
        let axis = Axis::of(values.iter().copied()).unwrap();
        let counts = counts(&sorted, &axis);
        assert_eq!(counts.iter().sum::<usize>(), 500);
        assert!(counts.len() > 3 && counts.len() <= 60, "{counts:?}");
        assert_eq!(histogram("t", "x", &[], |v| v.to_string()), "");
        assert!(histogram("t", "x", &[2.0, 2.0], |v| v.to_string()).contains("2 units"));
    }

    #[test]
    fn ticks_are_round() {
        let ticks = |low, high| Axis { low, high }.ticks();
        assert_eq!(ticks(0.0, 10.5), [0.0, 5.0, 10.0]);
        assert_eq!(ticks(24.4, 37.5), [25.0, 30.0, 35.0]);
        assert_eq!(ticks(-0.4, 0.6).len(), 6);
    }

    #[test]
    fn names_of_users_are_no_markup() {
        let row = Interval { label: "<script>".into(), value: 1.0, ends: [0.0, f64::INFINITY], is_marked: true };
        let svg = intervals("a & b", "x", &[row], Some(0.0), |v| format!("{v:.1}"));
        assert!(svg.contains("&lt;script&gt;") && svg.contains("a &amp; b") && !svg.contains("<script"), "{svg}");
        assert!(!svg.contains("inf") && !svg.contains("NaN"), "{svg}");
    }
}
