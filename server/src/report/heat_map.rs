//! The mean residual over two axes as SVG.

use super::number::scale;
use jointbench_model::{MapCell, PairMap, words};
use maud::{Markup, html};

const WIDTH: usize = 720;
/// Room for the numbers and the title of the vertical axis.
const LEFT: usize = 90;
const ROW: usize = 22;
/// Room for the numbers and the title of the horizontal axis.
const BOTTOM: usize = 44;
/// Red, green and blue of the map of the dashboard: zero, negative and positive end.
const MIDDLE: [f64; 3] = [236.0, 235.0, 230.0];
const NEGATIVE: [f64; 3] = [11.0, 95.0, 165.0];
const POSITIVE: [f64; 3] = [183.0, 65.0, 14.0];

/// Cells with the mean residual as number and colour, and the meaning of both.
pub fn heat_map(map: &PairMap, unit: &str) -> Markup {
    let largest = map.cells.iter().map(|cell| cell.mean.abs()).fold(0.0, f64::max);
    let (factor, unit) = scale(largest, unit);
    let (columns, rows) = (map.x_bins.len().max(1), map.y_bins.len().max(1));
    let (width, floor) = ((WIDTH - LEFT) / columns, rows * ROW);
    let (x, y) = (Axis::new(&map.x, &map.x_unit, &map.x_bins), Axis::new(&map.y, &map.y_unit, &map.y_bins));
    let places = places(largest * factor, 2);
    html! {
        figure {
            figcaption { "Residual map over " (words::spoken(&map.x)) " and " (words::spoken(&map.y)) " [" (unit) "]" }
            svg xmlns="http://www.w3.org/2000/svg" viewBox=(format!("0 0 {WIDTH} {}", floor + BOTTOM)) width=(WIDTH)
                font-family="sans-serif" font-size="12" text-anchor="middle" fill="#1b1f24" {
                @for cell in &map.cells {
                    (drawn(cell, [LEFT + cell.x * width, (rows - 1).saturating_sub(cell.y) * ROW], width,
                        cell.mean / largest.max(f64::MIN_POSITIVE), &words::with_minus(&format!("{:.places$}", cell.mean * factor))))
                }
                @for (place, number) in x.numbers.iter().enumerate() {
                    text x=(LEFT + place * width + width / 2) y=(floor + 15) { (number) }
                }
                @for (place, number) in y.numbers.iter().enumerate() {
                    text x=(LEFT - 6) y=(floor - place * ROW - 7) text-anchor="end" { (number) }
                }
                text x=(LEFT + columns * width / 2) y=(floor + 35) { (x.title) }
                text transform=(format!("translate(14 {}) rotate(-90)", floor / 2)) { (y.title) }
            }
            p.quiet {
                "Mean of measured − model in each cell. Bold: the 95 % band, simultaneous over all cells, excludes zero. "
                "Without a number: fewer than three independent blocks."
            }
        }
    }
}

/// A cell has a number if it has a band.
fn drawn(cell: &MapCell, [x, y]: [usize; 2], width: usize, share: f64, number: &str) -> Markup {
    let is_significant = cell.half_width.is_some_and(|half| cell.mean.abs() > half);
    let is_dark = share.abs() > 0.5;
    html! {
        rect x=(x) y=(y) width=(width) height=(ROW) fill=(colour(share)) stroke="#fff" opacity=[cell.half_width.is_none().then_some("0.4")] {}
        @if cell.half_width.is_some() {
            text x=(x + width / 2) y=(y + 15) fill=[is_dark.then_some("#fff")] font-weight=[is_significant.then_some("bold")] { (number) }
        }
    }
}

fn colour(share: f64) -> String {
    let end = if share < 0.0 { NEGATIVE } else { POSITIVE };
    let mixed = |i: usize| (MIDDLE[i] + (end[i] - MIDDLE[i]) * share.abs().min(1.0)).round();
    format!("rgb({},{},{})", mixed(0), mixed(1), mixed(2))
}

/// Title with the unit, and the middle of each bin.
struct Axis {
    title: String,
    numbers: Vec<String>,
}

impl Axis {
    fn new(name: &str, unit: &str, bins: &[[f64; 2]]) -> Self {
        let title = words::spoken(name);
        let middles: Vec<f64> = bins.iter().map(|[from, to]| (from + to) / 2.0).collect();
        if name == "direction" {
            let way = |middle: &f64| if *middle < 0.0 { "negative" } else { "positive" };
            return Self { title, numbers: middles.iter().map(|middle| way(middle).to_owned()).collect() };
        }
        let largest = middles.iter().fold(0.0, |largest: f64, middle| largest.max(middle.abs()));
        let (factor, unit) = scale(largest, unit);
        let places = places(largest * factor, 3);
        let number = |middle: &f64| words::with_minus(&format!("{:.places$}", middle * factor));
        let title = if unit.is_empty() { title } else { format!("{title} [{unit}]") };
        Self { title, numbers: middles.iter().map(number).collect() }
    }
}

/// Decimals for this many digits of the largest number.
fn places(largest: f64, digits: i32) -> usize {
    let whole = if largest > 0.0 { largest.log10().floor() } else { 0.0 };
    (f64::from(digits - 1) - whole).clamp(0.0, 12.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_has_numbers_in_the_unit_of_its_largest_cell() {
        let cell = |x, y, mean, half_width| MapCell { x, y, mean, half_width, rows: 9 };
        let map = PairMap {
            x: "motor_velocity_rad_s".to_owned(),
            x_unit: "rad/s".to_owned(),
            y: "direction".to_owned(),
            y_unit: "1".to_owned(),
            x_bins: vec![[-30.0, -10.0], [10.0, 30.0]],
            y_bins: vec![[-1.0, -1.0], [1.0, 1.0]],
            cells: vec![cell(0, 0, -8e-3, Some(1e-3)), cell(1, 0, 1e-3, None), cell(1, 1, 2e-3, Some(3e-3))],
            removable_share: 0.5,
        };
        let text = heat_map(&map, "Nm").into_string();
        assert!(text.contains("over motor velocity and direction [mNm]"), "{text}");
        assert!(
            text.contains("motor velocity [rad/s]") && text.contains(">−20.0<") && text.contains(">negative<"),
            "{text}"
        );
        assert!(text.contains("font-weight=\"bold\">−8.0<") && text.contains(">2.0<"), "{text}");
        assert!(!text.contains(">1.0<"), "a cell without a band has no number: {text}");
    }
}
