//! Prints residual maps for a person.

use jointbench_instrument::Kind;
use jointbench_model::{AxisMap, MapBin, MapCell, PairMap, ResidualMaps, words};

/// Length of the largest mean in characters, on each side.
const REACH: f64 = 20.0;
/// Axes that explain a smaller share of the squared error are named and not drawn.
const DRAWN_SHARE: f64 = 0.01;

/// Axes in `named`, those of the summary, are always drawn.
pub fn print(maps: &ResidualMaps, named: &[String], kind: Kind) {
    let mut axes: Vec<(&AxisMap, Option<&PairMap>)> =
        maps.axes.iter().map(|a| (a, maps.in_each_direction(a))).collect();
    axes.sort_by(|a, b| explained_share(b).total_cmp(&explained_share(a)));
    let is_drawn = |axis: &(&AxisMap, _)| explained_share(axis) >= DRAWN_SHARE || named.contains(&axis.0.axis);
    let (axes, flat): (Vec<_>, Vec<_>) = axes.into_iter().partition(is_drawn);
    let cells = axes.iter().flat_map(by_direction).flat_map(|pair| &pair.cells).map(|cell| cell.mean);
    let means = axes.iter().flat_map(|(axis, _)| &axis.bins).map(|bin| bin.mean).chain(cells);
    let largest = means.fold(f64::MIN_POSITIVE, |most, mean| most.max(mean.abs()));
    println!();
    if !axes.is_empty() {
        println!("residual maps: mean residual (measured − model) over each quantity");
        println!("±: simultaneous 95 % band; ● significant, ○ not significant, ? too few blocks");
    }
    for axis in &axes {
        println!();
        println!("{}", title(axis));
        match by_direction(axis) {
            None => axis.0.bins.iter().for_each(|bin| println!("{}", line(bin, &maps.unit, largest))),
            Some(pair) => {
                for (y, [from, _]) in pair.y_bins.iter().enumerate() {
                    println!("{}:", words::direction_text(kind, *from > 0.0));
                    let side = pair.cells.iter().filter(|cell| cell.y == y);
                    side.for_each(|cell| println!("{}", line(&bin(pair, cell), &maps.unit, largest)));
                }
            }
        }
    }
    if !flat.is_empty() {
        let names: Vec<&str> = flat.iter().map(|(axis, _)| axis.axis.as_str()).collect();
        println!();
        println!(
            "no structure over {}: each explains less than 1 % of the squared error, also by direction",
            words::list(&names)
        );
    }
}

/// Explained share with the criterion of the verdict: common to both directions, or by direction.
fn explained_share((axis, sides): &(&AxisMap, Option<&PairMap>)) -> f64 {
    sides.map_or(axis.removable_share, |pair| pair.removable_share.max(axis.removable_share))
}

/// The map by direction, if the directions mask each other's structure.
fn by_direction<'m>((axis, sides): &(&AxisMap, Option<&'m PairMap>)) -> Option<&'m PairMap> {
    sides.filter(|pair| pair.removable_share - axis.removable_share >= DRAWN_SHARE)
}

fn title(of: &(&AxisMap, Option<&PairMap>)) -> String {
    let axis = of.0;
    let unit = if axis.unit == "1" { String::new() } else { format!(" [{}]", axis.unit) };
    let percent = |share: f64| 100.0 * share.max(0.0);
    let apart = by_direction(of).map(|pair| format!(", {:.1} % by direction", percent(pair.removable_share)));
    format!(
        "{}{unit}: explains {:.1} % of the squared error{}",
        axis.axis,
        percent(axis.removable_share),
        apart.unwrap_or_default()
    )
}

/// Converts a cell of a map by direction to a bin of its axis.
fn bin(pair: &PairMap, cell: &MapCell) -> MapBin {
    let [from, to] = pair.x_bins[cell.x];
    let (mean, half_width, rows) = (cell.mean, cell.half_width, cell.rows);
    MapBin { from, to, centre: 0.5 * (from + to), mean, half_width, rows }
}

fn line(bin: &MapBin, unit: &str, largest: f64) -> String {
    let (sign, known) = match bin.half_width {
        None => ('?', String::new()),
        Some(half) => (if bin.mean.abs() > half { '●' } else { '○' }, format!("±{}", words::figure(half, unit))),
    };
    let length = (REACH * bin.mean.abs() / largest).round() as usize;
    let (below, above) = if bin.mean < 0.0 { (length, 0) } else { (0, length) };
    let reach = REACH as usize;
    format!(
        "{:>10} … {:<10} {sign} {:>11} {known:<12} {}{}│{}",
        super::figure(bin.from),
        super::figure(bin.to),
        words::figure(bin.mean, unit),
        " ".repeat(reach - below),
        "█".repeat(below),
        "█".repeat(above),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_shows_place_value_and_noise() {
        let bin = |mean, half_width| MapBin { from: 2.0, to: 4.0, centre: 3.0, mean, half_width, rows: 9 };
        let drawn = |mean, half_width| line(&bin(mean, half_width), "Nm", 4e-3);
        let below = drawn(-2e-3, Some(5e-4));
        assert!(below.contains('●') && below.contains("−2.00 mNm") && below.contains("±500 µNm"), "{below}");
        assert!(below.ends_with("          ██████████│"), "{below}");
        assert!(drawn(1e-3, Some(2e-3)).contains('○') && drawn(1e-3, None).contains('?'));
        assert!(drawn(4e-3, None).ends_with(&format!("│{}", "█".repeat(20))));
    }
}
