//! Residual maps, as a person reads them.

use jointbench_model::{AxisMap, MapBin, ResidualMaps, words};

/// Characters of the largest mean, to either side.
const REACH: f64 = 20.0;
/// A quantity of which a function would take less off the squared error is named and not drawn.
const DRAWN_SHARE: f64 = 0.01;

pub fn print(maps: &ResidualMaps) {
    let mut axes: Vec<&AxisMap> = maps.axes.iter().collect();
    axes.sort_by(|a, b| b.removable_share.total_cmp(&a.removable_share));
    let (axes, flat): (Vec<&AxisMap>, Vec<&AxisMap>) =
        axes.into_iter().partition(|axis| axis.removable_share >= DRAWN_SHARE);
    let means = axes.iter().flat_map(|axis| &axis.bins).map(|bin| bin.mean.abs());
    let largest = means.fold(f64::MIN_POSITIVE, f64::max);
    println!();
    if !axes.is_empty() {
        println!("where the model fails: mean of what it leaves (measured − model) over each quantity");
        println!(
            "± holds for every line at once; ● is no noise, ○ may be, ? from too few pieces of the run to be judged"
        );
    }
    for axis in axes {
        println!();
        println!("{}", title(axis));
        for bin in &axis.bins {
            println!("{}", line(bin, &maps.unit, largest));
        }
    }
    if !flat.is_empty() {
        let names: Vec<&str> = flat.iter().map(|axis| axis.axis.as_str()).collect();
        println!();
        println!("flat over {}: a function of one would take less than 1 % off", words::list(&names));
    }
}

fn title(axis: &AxisMap) -> String {
    let unit = if axis.unit == "1" { String::new() } else { format!(" [{}]", axis.unit) };
    let share = 100.0 * axis.removable_share;
    format!("{}{unit}: a function of it would take {share:.1} % off the squared error", axis.axis)
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
    fn a_line_says_where_how_much_and_whether_it_is_noise() {
        let bin = |mean, half_width| MapBin { from: 2.0, to: 4.0, centre: 3.0, mean, half_width, rows: 9 };
        let drawn = |mean, half_width| line(&bin(mean, half_width), "Nm", 4e-3);
        let below = drawn(-2e-3, Some(5e-4));
        assert!(below.contains('●') && below.contains("-2.00 mNm") && below.contains("±500 µNm"), "{below}");
        assert!(below.ends_with("          ██████████│"), "{below}");
        assert!(drawn(1e-3, Some(2e-3)).contains('○') && drawn(1e-3, None).contains('?'));
        assert!(drawn(4e-3, None).ends_with(&format!("│{}", "█".repeat(20))));
    }
}
